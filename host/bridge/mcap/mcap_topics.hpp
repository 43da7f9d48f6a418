// Topics in an MCAP file, as `ros2 bag record` would write them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "host/bridge/topics/topic_sink.hpp"
#include "host/io/mcap/mcap_writer.hpp"

namespace octoskin::bridge {

/// `offered_qos_profiles` of a topic: the YAML of rosbag2, which `ros2 bag play` offers again.
[[nodiscard]] std::string qos_profiles(const ros::Qos& qos);

class McapTopics final : public TopicSink {
  public:
    struct Count {
        std::string type;
        std::uint64_t messages = 0;
    };

    /// Whether messages of this topic go into the file.
    using Choice = std::function<bool(const std::string& topic)>;

    /// `file` must outlive this object.
    McapTopics(mcap::McapWriter& file, Choice choice) : file_(file), choice_(std::move(choice)) {}

    /// Messages of this topic are refused, until `resume`: its writers have no reader.
    void pause(const std::string& topic) { paused_.insert(topic); }
    void resume(const std::string& topic) { paused_.erase(topic); }
    [[nodiscard]] bool takes(const std::string& topic) const {
        return !paused_.contains(topic) && choice_(topic);
    }

    /// Writers of one topic share its channel, which is in the file once it has a message.
    [[nodiscard]] Result<std::unique_ptr<TopicWriter>, Error> writer(const std::string& topic,
                                                                     const ros::TypeName& type,
                                                                     const ros::Qos& qos) override;

    /// The file could not be written.
    [[nodiscard]] bool has_failed() const noexcept { return has_failed_; }
    /// Of each topic that was opened.
    [[nodiscard]] const std::map<std::string, Count>& counts() const noexcept { return counts_; }

  private:
    class Writer;
    mcap::McapWriter& file_;
    Choice choice_;
    std::set<std::string> paused_;
    std::map<std::string, std::uint16_t> channels_;
    std::map<std::string, Count> counts_;
    bool has_failed_ = false;
};

}  // namespace octoskin::bridge
