// Replaces operator new and delete in a test program that controls allocations. Include it in one source
// only.
#pragma once

#include <cstddef>
#include <new>

/// Defined by the program: the memory of every `new`; throws std::bad_alloc.
static void* allocate(std::size_t bytes);
/// Defined by the program: frees the memory of every `delete`.
static void release(void* place) noexcept;

void* operator new(std::size_t bytes) {
    return allocate(bytes);
}
void* operator new[](std::size_t bytes) {
    return allocate(bytes);
}
// Also replaced, because the library's version would allocate memory that the `delete` here frees.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept try {
    return allocate(bytes);
} catch (const std::bad_alloc&) {
    return nullptr;
}
void* operator new[](std::size_t bytes, const std::nothrow_t& none) noexcept {
    return operator new(bytes, none);
}
void operator delete(void* place) noexcept {
    release(place);
}
void operator delete[](void* place) noexcept {
    release(place);
}
void operator delete(void* place, std::size_t) noexcept {
    release(place);
}
void operator delete[](void* place, std::size_t) noexcept {
    release(place);
}
