// The number of cases of a seeded test.
#pragma once

namespace octoskin::testing_support {

/// `count`, or a fifth of them under a sanitizer: it checks each access, the accesses of all cases are alike,
/// and it takes twenty to eighty times as long.
constexpr unsigned cases(unsigned count) {
#ifdef OCTOSKIN_SANITIZED
    return (count + 4) / 5;
#else
    return count;
#endif
}

}  // namespace octoskin::testing_support
