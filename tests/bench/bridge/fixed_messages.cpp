// Publishes one message of a fixed size again and again, as octoskin-bridge would: transport without
// encoding.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <thread>

#include "host/bridge/cdr/cdr_writer.hpp"
#include "host/bridge/dds/participant.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge_bench {
namespace {

struct Options {
    std::string topic = "/octoskin/octomap_binary";
    std::size_t bytes = std::size_t{1} << 20U;
    double rate_hz = 10.0;
    bool this_machine_only = false;
};

cdr::Bytes message_of(std::size_t bytes) {
    ros::octomap_msgs::Octomap octomap;
    octomap.binary = true;
    octomap.id = "OcTree";
    octomap.data.assign(bytes, 1);
    return cdr::write(octomap);
}

int publish(const Options& options) {
    const auto network = dds::network_of(dds::process_environment, options.this_machine_only);
    const auto participant = dds::Participant::open(network.value());
    const auto writer = (*participant)
                            ->writer(options.topic, ros::octomap_msgs::Octomap::kType,
                                     {dds::Reliability::reliable, dds::Durability::transient_local, 1});
    if (!writer) {
        std::cerr << writer.error().message() << '\n';
        return 1;
    }
    const cdr::Bytes message = message_of(options.bytes);
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / options.rate_hz));
    for (auto next = std::chrono::steady_clock::now();; std::this_thread::sleep_until(next += period))
        if (writer->readers() > 0 && !writer->write(message)) return 1;
}

}  // namespace
}  // namespace octoskin::bridge_bench

int main(int count, char** words) {
    octoskin::bridge_bench::Options options;
    CLI::App app("Publishes a message of a fixed size.");
    app.add_option("--topic", options.topic, "of octomap_msgs/Octomap")->capture_default_str();
    app.add_option("--bytes", options.bytes, "of the octree")->capture_default_str();
    app.add_option("--rate", options.rate_hz, "messages a second")->capture_default_str();
    app.add_flag("--this-machine-only", options.this_machine_only, "as octoskin-bridge");
    CLI11_PARSE(app, count, words);
    return octoskin::bridge_bench::publish(options);
}
