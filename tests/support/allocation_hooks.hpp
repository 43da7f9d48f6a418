// The operators of a test program that decides itself what an allocation gives. For the program's one source.
#pragma once

#include <cstddef>
#include <new>

/// Defined by the program: what every `new` gives; throws std::bad_alloc.
static void* allocate(std::size_t bytes);
/// And every `delete` takes.
static void release(void* place) noexcept;

void* operator new(std::size_t bytes) {
    return allocate(bytes);
}
void* operator new[](std::size_t bytes) {
    return allocate(bytes);
}
// The library's own would give what ours then takes back.
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
