#include "host/apps/recording/shortage.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

namespace octoskin {
namespace {

std::system_error failed(int error_number) {
    return {error_number, std::generic_category(), "cannot do it"};
}

TEST(Shortage, is_what_the_system_has_too_little_of) {
    for (const int error_number : {EMFILE, ENFILE, EAGAIN, ENOMEM, EFBIG}) {
        const auto shortage = shortage_in(failed(error_number));
        ASSERT_TRUE(shortage) << error_number;
        EXPECT_EQ(static_cast<int>(shortage->exit), 71);
        EXPECT_EQ(shortage->error.code,
                  error_number == EFBIG ? ErrorCode::too_large : ErrorCode::no_resources);
    }
    EXPECT_TRUE(shortage_in(std::bad_alloc()));
    const std::error_code system(EMFILE, std::system_category());
    EXPECT_TRUE(shortage_in(std::system_error(system, "accept")));
    EXPECT_TRUE(shortage_in(std::filesystem::filesystem_error("no", system)));
}

TEST(Shortage, is_no_other_fault) {
    EXPECT_FALSE(shortage_in(std::logic_error("a defect")));
    for (const int error_number : {EBADF, EINVAL, EPERM, ENOENT})
        EXPECT_FALSE(shortage_in(failed(error_number))) << error_number;
    EXPECT_FALSE(shortage_in(std::system_error(std::make_error_code(std::io_errc::stream))));
}

TEST(Shortage, names_the_limit_that_was_reached_and_how_it_is_raised) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
    const rlimit few{321, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
    const auto shortage = shortage_in(failed(EMFILE));
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    ASSERT_TRUE(shortage);
    EXPECT_NE(shortage->error.what.find("321"), std::string::npos) << shortage->message();
    EXPECT_NE(shortage->error.remedy.find("ulimit -n"), std::string::npos) << shortage->message();
}

TEST(Shortage, of_a_thread_names_the_limit_of_data_that_its_stack_counts_for) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_DATA, &before), 0);
    const rlimit much{rlim_t{54321} << 20U, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_DATA, &much), 0);
    const auto shortage = shortage_in(failed(EAGAIN));
    ASSERT_EQ(::setrlimit(RLIMIT_DATA, &before), 0);
    ASSERT_TRUE(shortage);
    EXPECT_NE(shortage->error.what.find("54321"), std::string::npos) << shortage->message();
    EXPECT_NE(shortage->error.remedy.find("ulimit -d"), std::string::npos) << shortage->message();
}

}  // namespace
}  // namespace octoskin
