// Memory for destructors. Oracle: the handler that operator new calls where there is no memory, called by
// hand: it returns where it has made room, and throws where it has none.
#include "host/apps/daemon/unwinding_room.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/apps/query/query_answer.hpp"

namespace octoskin {
namespace {

class UnwindingRoomTest : public testing::Test {
  protected:
    UnwindingRoomTest() { UnwindingRoom::keep(); }
    ~UnwindingRoomTest() override {
        UnwindingRoom::spend();
        std::set_new_handler(before_);
    }
    static void allocation_fails() { std::get_new_handler()(); }

  private:
    std::new_handler before_ = std::get_new_handler();
};

TEST_F(UnwindingRoomTest, is_not_for_an_allocation_that_may_fail) {
    EXPECT_THROW(allocation_fails(), std::bad_alloc);
}

TEST_F(UnwindingRoomTest, is_given_once_while_an_exception_is_on_its_way) {
    struct FailsTwice {
        ~FailsTwice() {
            allocation_fails();
            EXPECT_THROW(allocation_fails(), std::bad_alloc);
        }
    };
    try {
        const FailsTwice destroyed;
        throw std::bad_alloc();
    } catch (const std::bad_alloc&) {
    }
}

TEST_F(UnwindingRoomTest, of_an_answer_is_for_its_first_allocation_that_fails) {
    constexpr std::size_t kBytes = std::size_t{1} << 20U;
    {
        const AnswerRoom room(kBytes);
        allocation_fails();
        EXPECT_THROW(allocation_fails(), std::bad_alloc) << "it has been given";
    }
    EXPECT_THROW(allocation_fails(), std::bad_alloc) << "there is no answer";
    const AnswerRoom room(kBytes);
    allocation_fails();
}

TEST_F(UnwindingRoomTest, of_an_answer_has_a_refusal_like_any_other) {
    const AppError refused{ExitCode::unavailable, {ErrorCode::no_resources, "no memory for an answer"}};
    EXPECT_EQ(AnswerRoom::kRefusal, query_refused(refused).dump());
}

TEST_F(UnwindingRoomTest, of_an_answer_is_refused_where_there_is_none) {
    std::optional<AnswerRoom> room;
    EXPECT_THROW(room.emplace(std::numeric_limits<std::size_t>::max() / 2), std::bad_alloc);
    EXPECT_THROW(allocation_fails(), std::bad_alloc);
}

}  // namespace
}  // namespace octoskin
