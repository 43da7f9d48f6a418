// System functions that newlib needs and its rdimon library lacks.
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

#include "tests/support/target/semihosting.hpp"

extern "C" {

// GCC's start files would define these three, but also a second start-up. Constructors are in .init_array.
void* __dso_handle = nullptr;
void _init() {}
void _fini() {}

void _exit(int exit_code) {
    octoskin::target::end_machine(exit_code);
}

// abort() ends here. The signal's number is dropped: any end by signal is a failure.
int _kill(int, int) {
    octoskin::target::end_machine(1);
}

// No randomness and no folders: these calls return an error. GoogleTest uses them only for the names of its
// output files.
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
