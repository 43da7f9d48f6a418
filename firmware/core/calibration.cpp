#include "firmware/core/calibration.hpp"

#include <algorithm>

namespace octoskin::node {

namespace {

using wire::CalibrationOutcome;

CalibrationOutcome outcome_of(vl53l1x::CalibrationError error) noexcept {
    switch (error) {
        case vl53l1x::CalibrationError::device:
            return CalibrationOutcome::device_failed;
        case vl53l1x::CalibrationError::unsupported_target:
            return CalibrationOutcome::refused;
        case vl53l1x::CalibrationError::no_result:
            return CalibrationOutcome::no_result;
        case vl53l1x::CalibrationError::no_target:
            return CalibrationOutcome::no_target;
        case vl53l1x::CalibrationError::out_of_range:
            return CalibrationOutcome::out_of_range;
    }
    return CalibrationOutcome::device_failed;
}

wire::Calibration answer_to(const wire::Command& command, CalibrationOutcome outcome) noexcept {
    return {.sensor = command.sensor,
            .quantity = order_of(command).quantity,
            .outcome = outcome,
            .sequence = command.sequence};
}

}  // namespace

CalibrationResult result_of(const vl53l1x::CalibrationRun& run, vl53l1x::Progress progress) noexcept {
    if (progress != vl53l1x::Progress::done) return {.outcome = outcome_of(run.error())};
    return {.outcome = CalibrationOutcome::done,
            .offset_quarter_mm = run.offset_quarter_mm(),
            .crosstalk_raw = run.crosstalk_raw()};
}

CalibrationOrder order_of(const wire::Command& command) noexcept {
    const bool is_offset = command.code == wire::CommandCode::calibrate_offset;
    return {.quantity = is_offset ? wire::CalibrationQuantity::offset : wire::CalibrationQuantity::crosstalk,
            .target_mm = command.argument};
}

void CalibrationDialogue::accept(const wire::Command& command) noexcept {
    under_way_ = answer_to(command, CalibrationOutcome::under_way);
    answer(*under_way_);
    ends_left_ = 0;
    is_end_due_ = false;
}

void CalibrationDialogue::refuse(const wire::Command& command) noexcept {
    answer(answer_to(command, CalibrationOutcome::refused));
}

bool CalibrationDialogue::answers_again(const wire::Command& command) noexcept {
    if (!under_way_ || *under_way_ != answer_to(command, CalibrationOutcome::under_way)) return false;
    answer(*under_way_);
    return true;
}

void CalibrationDialogue::answer(const wire::Calibration& answer) noexcept {
    if (answer_count_ < answers_.size()) answers_[answer_count_++] = answer;
}

void CalibrationDialogue::end(const CalibrationResult& result) noexcept {
    ended_ = *under_way_;
    ended_.outcome = result.outcome;
    ended_.offset_quarter_mm = result.offset_quarter_mm;
    ended_.crosstalk_raw = result.crosstalk_raw;
    ends_left_ = kEndsSent;
    is_end_due_ = true;
    under_way_.reset();
}

std::optional<wire::Calibration> CalibrationDialogue::due() const noexcept {
    if (answer_count_ > 0) return answers_.front();
    return is_end_due_ ? std::optional(ended_) : std::nullopt;
}

void CalibrationDialogue::sent() noexcept {
    if (answer_count_ > 0) {
        std::move(answers_.begin() + 1, answers_.begin() + answer_count_, answers_.begin());
        --answer_count_;
        return;
    }
    --ends_left_;
    is_end_due_ = false;
}

}  // namespace octoskin::node
