// Subscribes to topics with Fast DDS and prints what comes: the README.md of this folder.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <filesystem>
#include <fstream>
#include <list>
#include <stdexcept>

#include "tests/ros/discovery.hpp"
#include "tests/ros/output.hpp"

namespace octoskin::ros {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr const char* kUsage =
    R"(usage: ros_listen [options] [TOPIC TYPE]...       (ros_listen /joint_states sensor_msgs/JointState)

  --domain N         ROS_DOMAIN_ID, 0
  --seconds S        ends after S seconds, 10
  --count N          ends after N samples of all topics together
  --qos reliable|best_effort
  --durability volatile|transient_local
  --depth N          samples kept unread, 10
  --raw DIR          writes the bytes of each sample to DIR/NUMBER.cdr
  --all-bytes        prints sequences of bytes whole, not the first 32 of them
  --quiet            prints no samples, only the counts at the end
  --publishers       prints the writers and readers of the domain

Fast DDS is not configured. Ends with a line of counts; exit code 0, also without any sample.
)";

struct Settings {
    int domain = 0;
    double seconds = 10;
    int count = 0;  ///< 0: any
    Qos qos;
    std::string raw_folder;
    Shown shown;
    bool is_quiet = false;
    bool prints_endpoints = false;
    std::vector<std::string> topics_and_types;
};

Settings settings_of(const Arguments& arguments) {
    Settings settings;
    settings.domain = arguments.whole("--domain", 0);
    settings.seconds = arguments.number("--seconds", 10);
    settings.count = arguments.whole("--count", 0);
    settings.qos = qos_of(arguments);
    settings.raw_folder = arguments.text("--raw", "");
    settings.shown.has_all_bytes = arguments.has("--all-bytes");
    settings.is_quiet = arguments.has("--quiet");
    settings.prints_endpoints = arguments.has("--publishers");
    settings.topics_and_types = arguments.rest();
    if (settings.topics_and_types.size() % 2 != 0) {
        throw std::invalid_argument("topics and types come in pairs");
    }
    if (settings.topics_and_types.empty() && !settings.prints_endpoints) {
        throw std::invalid_argument("no topic (--help)");
    }
    return settings;
}

/// A topic that is listened to.
class Subscription : public dds::DataReaderListener {
  public:
    Subscription(std::string name, const Codec& type) : topic(std::move(name)), codec(type) {}
    void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
        print({{"event", "matched"}, {"topic", topic}, {"writers", status.current_count}});
    }

    const std::string topic;
    const Codec& codec;
    dds::DataReader* reader = nullptr;
    int taken = 0;
    int malformed = 0;
    std::size_t bytes = 0;
    std::vector<double> latencies_s;
};

double seconds_of(const eprosima::fastrtps::rtps::Time_t& time) {
    return static_cast<double>(time.to_ns()) * 1e-9;
}

/// The fields of a sample, or why it has none.
Json read_fields(Subscription& from, const Bytes& bytes, const Shown& shown) {
    try {
        const Decoded decoded = from.codec.decode(bytes, shown);
        return {{"unread", decoded.unread}, {"fields", decoded.fields}};
    } catch (const std::exception& error) {
        ++from.malformed;
        return {{"malformed", error.what()}};
    }
}

class Listening {
  public:
    explicit Listening(const Settings& settings)
        : settings_(settings),
          participant_(settings.domain, settings.prints_endpoints ? &printer_ : nullptr) {
        const auto& words = settings.topics_and_types;
        for (std::size_t i = 0; i < words.size(); i += 2) {
            add(words[i], find_codec(words[i + 1]));
        }
        if (!settings.raw_folder.empty()) {
            std::filesystem::create_directories(settings.raw_folder);
        }
        print({{"event", "ready"}});
    }

    void run() {
        const auto end = Clock::now() + Seconds(settings_.seconds);
        while (!is_told_to_end() && Clock::now() < end && !has_enough()) {
            dds::ConditionSeq active;
            wait_set_.wait(active, eprosima::fastrtps::Duration_t(0, 50'000'000));
            for (Subscription& subscription : subscriptions_) {
                take_from(subscription);
            }
        }
    }

    void print_counts() {
        Json topics = Json::object();
        for (Subscription& subscription : subscriptions_) {
            dds::SampleLostStatus lost;
            subscription.reader->get_sample_lost_status(lost);
            topics[subscription.topic] = {{"samples", subscription.taken},
                                          {"malformed", subscription.malformed},
                                          {"lost", lost.total_count},
                                          {"bytes", subscription.bytes},
                                          {"latency_ms", latency_of(subscription)}};
        }
        print({{"event", "counts"}, {"samples", number_}, {"topics", topics}});
    }

  private:
    void add(const std::string& topic, const Codec& codec) {
        Subscription& added = subscriptions_.emplace_back(topic, codec);
        added.reader = participant_.add_reader(topic, codec, settings_.qos, &added);
        auto& condition = added.reader->get_statuscondition();
        condition.set_enabled_statuses(dds::StatusMask::data_available());
        wait_set_.attach_condition(condition);
    }

    bool has_enough() const { return settings_.count > 0 && number_ >= settings_.count; }

    void take_from(Subscription& subscription) {
        Bytes bytes;
        dds::SampleInfo info;
        while (!has_enough() &&
               subscription.reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
            if (info.valid_data) {
                take(subscription, bytes, info);
            }
        }
    }

    void take(Subscription& from, const Bytes& bytes, const dds::SampleInfo& info) {
        ++number_;
        ++from.taken;
        from.bytes += bytes.size();
        from.latencies_s.push_back(seconds_of(info.reception_timestamp) - seconds_of(info.source_timestamp));
        if (!settings_.raw_folder.empty()) {
            std::ofstream(settings_.raw_folder + "/" + std::to_string(number_) + ".cdr", std::ios::binary)
                .write(reinterpret_cast<const char*>(bytes.data()),
                       static_cast<std::streamsize>(bytes.size()));
        }
        const Json fields = read_fields(from, bytes, settings_.shown);
        if (settings_.is_quiet) {
            return;
        }
        Json event = {{"event", "sample"},
                      {"number", number_},
                      {"topic", from.topic},
                      {"type", from.codec.name},
                      {"at_s", seconds_of(info.reception_timestamp)},
                      {"source_s", seconds_of(info.source_timestamp)},
                      {"size", bytes.size()}};
        event.update(fields);
        print(event);
    }

    static Json latency_of(Subscription& subscription) {
        auto& sorted = subscription.latencies_s;
        if (sorted.empty()) {
            return nullptr;
        }
        std::sort(sorted.begin(), sorted.end());
        const auto at = [&](std::size_t percent) {
            return sorted[(sorted.size() - 1) * percent / 100] * 1e3;
        };
        return {{"p50", at(50)}, {"p90", at(90)}, {"p99", at(99)}, {"max", sorted.back() * 1e3}};
    }

    Settings settings_;
    EndpointPrinter printer_;
    std::list<Subscription> subscriptions_;  // outlive the readers, whose listeners they are
    dds::WaitSet wait_set_;                  // detached only after the readers are gone
    Participant participant_;
    int number_ = 0;
};

/// A malformed sample may announce billions of elements: allocating them must fail, not exhaust the machine.
void limit_memory() {
    const rlimit limit{std::size_t{1} << 30, std::size_t{1} << 30};
    setrlimit(RLIMIT_DATA, &limit);
}

int listen(int count, char** words) {
    const Arguments arguments(
        count, words, {"--all-bytes", "--quiet", "--publishers"},
        {"--domain", "--seconds", "--count", "--qos", "--durability", "--depth", "--raw"});
    limit_memory();
    Listening listening(settings_of(arguments));
    listening.run();
    listening.print_counts();
    return 0;
}

}  // namespace
}  // namespace octoskin::ros

int main(int count, char** words) {
    return octoskin::ros::run_program(count, words, octoskin::ros::kUsage, &octoskin::ros::listen);
}
