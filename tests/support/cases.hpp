// How many cases a seeded test goes through.
#pragma once

namespace octoskin::testing_support {

/// `count`, or a fifth of them under a sanitizer: it looks at each access, of which every case has the same,
/// and takes twenty to eighty times as long.
constexpr unsigned cases(unsigned count) {
#ifdef OCTOSKIN_SANITIZED
    return (count + 4) / 5;
#else
    return count;
#endif
}

}  // namespace octoskin::testing_support
