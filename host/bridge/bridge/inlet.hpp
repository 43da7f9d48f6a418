// A topic that the bridge subscribes to, as reliably as its publishers offer it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/bridge/dds/participant.hpp"

namespace octoskin::bridge {

class Inlet {
  public:
    /// Messages of more than `bytes_max` are dropped on arrival.
    Inlet(const dds::Participant& participant, std::string topic, ros::TypeName type,
          dds::Durability durability, std::int32_t keep_last, std::size_t bytes_max)
        : participant_(&participant),
          topic_(std::move(topic)),
          type_(type),
          durability_(durability),
          keep_last_(keep_last),
          bytes_max_(bytes_max) {}

    [[nodiscard]] const std::string& topic() const noexcept { return topic_; }
    /// Publishers of this topic and type.
    [[nodiscard]] std::size_t publishers() const noexcept { return publishers_; }
    /// The type of a publisher of this topic with another type; empty: there is none.
    [[nodiscard]] const std::string& other_type() const noexcept { return other_type_; }
    /// Messages that the writers numbered and that did not come: lost on the way and not repeated, or
    /// replaced by newer ones before this program took them. Seen when the next one comes.
    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

    /// Subscribes, if there are publishers: reliably if all of them are reliable. `writers`: of all other
    /// participants.
    void attend(const std::vector<dds::Endpoint>& writers) {
        publishers_ = 0;
        other_type_.clear();
        bool are_reliable = true;
        bool are_kept = true;
        for (const dds::Endpoint& writer : writers) {
            if (writer.topic != "rt" + topic_) continue;
            if (writer.type != type_.dds) {
                other_type_ = writer.type;
                continue;
            }
            ++publishers_;
            are_reliable &= writer.reliability == dds::Reliability::reliable;
            are_kept &= writer.durability == dds::Durability::transient_local;
        }
        if (publishers_ == 0) return;
        const dds::Qos wanted{are_reliable ? dds::Reliability::reliable : dds::Reliability::best_effort,
                              are_kept && durability_ == dds::Durability::transient_local
                                  ? dds::Durability::transient_local
                                  : dds::Durability::volatile_,
                              keep_last_};
        const bool is_same =
            reader_ && qos_.reliability == wanted.reliability && qos_.durability == wanted.durability;
        if (is_same) return;
        auto reader = participant_->reader(topic_, type_, wanted, bytes_max_);
        if (!reader) return;  // tried again at the next change
        reader_ = std::move(reader).value();
        newest_.clear();
        qos_ = wanted;
    }

    [[nodiscard]] std::vector<dds::Sample> take(std::size_t count) {
        if (!reader_) return {};
        std::vector<dds::Sample> samples = reader_.take(count);
        for (const dds::Sample& sample : samples) note(sample);
        return samples;
    }

  private:
    static constexpr std::size_t kWritersMax = 64;  ///< of some that have gone, too

    void note(const dds::Sample& sample) {
        if (newest_.size() > kWritersMax) newest_.clear();
        const auto [newest, is_first] = newest_.try_emplace(sample.writer, sample.number);
        if (!is_first && sample.number > newest->second + 1)
            lost_ += static_cast<std::uint64_t>(sample.number - newest->second - 1);
        newest->second = std::max(newest->second, sample.number);
    }

    const dds::Participant* participant_;
    std::string topic_;
    ros::TypeName type_;
    dds::Durability durability_;
    std::int32_t keep_last_;
    std::size_t bytes_max_;
    dds::Reader reader_;
    dds::Qos qos_;
    std::size_t publishers_ = 0;
    std::string other_type_;
    std::map<std::uint64_t, std::int64_t> newest_;  ///< number of the newest sample of each writer
    std::uint64_t lost_ = 0;
};

}  // namespace octoskin::bridge
