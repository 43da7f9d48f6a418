// What newlib asks of a system and its rdimon library does not answer.
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

#include "tests/support/target/semihosting.hpp"

extern "C" {

// GCC's start files would bring these three, and a second start-up with them. Constructors are in
// .init_array.
void* __dso_handle = nullptr;
void _init() {}
void _fini() {}

void _exit(int exit_code) {
    octoskin::target::end_machine(exit_code);
}

// abort() ends here. The signal's number is lost on purpose: any end by signal is a failure.
int _kill(int, int) {
    octoskin::target::end_machine(1);
}

// No randomness and no folders: who asks gets an error, and GoogleTest asks only for its output files' names.
int getentropy(void*, std::size_t) {
    errno = ENOSYS;
    return -1;
}
char* getcwd(char*, std::size_t) {
    errno = ENOSYS;
    return nullptr;
}
int mkdir(const char*, mode_t) {
    errno = ENOSYS;
    return -1;
}

}  // extern "C"
