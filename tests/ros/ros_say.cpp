// Publishes messages with Fast DDS: the README.md of this folder.
#include <iostream>
#include <stdexcept>

#include "tests/ros/depth_images.hpp"
#include "tests/ros/headers.hpp"
#include "tests/ros/json_values.hpp"
#include "tests/ros/output.hpp"
#include "tests/ros/saying.hpp"

namespace octoskin::ros {
namespace {

constexpr const char* kUsage =
    R"(usage: ros_say [options] < LINES                                messages from JSON lines
       ros_say [options] --images WxH --topic TOPIC             depth images
       ros_say [options] --raw FILE TYPE TOPIC [--truncated]    the bytes of a file as a message

A line: {"topic": "/joint_states", "type": "sensor_msgs/JointState", "fields": {"name": ["a"], "position": [0.5]}}
A field that it lacks is 0 or empty. Bytes are {"hex": "01ff"}, {"size": 9, "value": 1}, {"file": "picture.png"} or a
list. Further members: "at_s", seconds after the first line's publication; "durability", "qos" and "depth" of the
topic's writer, as the options below; "cdr", the sample's bytes in hexadecimal digits, instead of "fields".

  --domain N         ROS_DOMAIN_ID, 0
  --qos reliable|best_effort
  --durability volatile|transient_local
  --depth N          samples kept, 10
  --readers N        a topic's first message waits for N readers, 1
  --wait S           for S seconds at most, 10
  --settle S         and S seconds more, until the readers know the writer, too, 0.2
  --linger S         stays S seconds after the last message, 0.5
  --until-read       stays until every reliable reader has everything: up to 3 s, Fast DDS's heartbeat period
  --rate HZ          one line or image each 1/HZ s; lines without it and without "at_s" follow at once, images
                     come at 30 Hz, cut messages at 200 Hz
  --repeat N         says the lines N times, 1
  --frame ID         header.frame_id of every message
  --stamp-now        header.stamp of every message is the time of its publication
  --count N          images, 100
  --encoding 16UC1|32FC1
  --depth-m D        of all pixels but the first, which counts the images from 0; 1
  --truncated        the file's bytes cut to every length from 1 to all but one, each once; DDS
                     pads them to a multiple of four

Ends with a line of counts.
)";

Saying::Settings settings_of(const Arguments& arguments) {
    return {arguments.whole("--domain", 0),    arguments.whole("--readers", 1),
            arguments.number("--wait", 10),    arguments.number("--settle", 0.2),
            arguments.number("--linger", 0.5), arguments.has("--until-read")};
}

/// Whether a member of a line, if it is there, is the first of two words. Throws std::invalid_argument if it
/// is neither.
bool is_first(const Json& line, const char* name, const std::string& first, const std::string& second,
              bool otherwise) {
    const std::string word = line.value(name, otherwise ? first : second);
    if (word != first && word != second) {
        throw std::invalid_argument(std::string(name) + ": unknown value '" + word + "'");
    }
    return word == first;
}

/// The options' QoS, except for what the line says.
Qos qos_of_line(const Json& line, const Qos& qos) {
    return {is_first(line, "qos", "reliable", "best_effort", qos.is_reliable),
            is_first(line, "durability", "transient_local", "volatile", qos.is_transient_local),
            line.value("depth", qos.depth)};
}

class LineSayer {
  public:
    LineSayer(const Arguments& arguments, Saying& saying)
        : saying_(saying),
          qos_(qos_of(arguments)),
          headers_(arguments),
          rate_hz_(arguments.number("--rate", 0)) {}

    void say(Json line) {
        const auto topic = line.at("topic").get<std::string>();
        const Codec& codec = find_codec(line.at("type").get<std::string>());
        saying_.writer_of(topic, codec, qos_of_line(line, qos_));
        if (said_ == 0) {
            start_ = Clock::now();
        }
        sleep_until(after(start_, line.value("at_s", rate_hz_ > 0 ? said_ / rate_hz_ : 0.0)));
        saying_.say(topic, bytes_of(line, codec));
        ++said_;
    }

  private:
    Bytes bytes_of(const Json& line, const Codec& codec) const {
        if (line.contains("cdr")) {
            return read_bytes({{"hex", line["cdr"]}}, Place{"cdr"});
        }
        Json fields = line.value("fields", Json::object());
        headers_.change(fields, codec);
        return codec.encode(fields);
    }

    Saying& saying_;
    Qos qos_;
    Headers headers_;
    double rate_hz_;
    Clock::time_point start_;
    int said_ = 0;
};

void say_lines(const Arguments& arguments, Saying& saying) {
    LineSayer sayer(arguments, saying);
    const int repeat = arguments.whole("--repeat", 1);
    std::vector<Json> lines;
    std::string text;
    while (!is_told_to_end() && std::getline(std::cin, text)) {
        if (!text.empty()) {
            lines.push_back(Json::parse(text));
            sayer.say(lines.back());
        }
    }
    for (int round = 1; round < repeat && !is_told_to_end(); ++round) {
        for (const Json& line : lines) {
            sayer.say(line);
        }
    }
}

void say_raw(const Arguments& arguments, Saying& saying) {
    if (arguments.rest().size() != 2) {
        throw std::invalid_argument("--raw FILE needs TYPE and TOPIC");
    }
    const Bytes bytes = read_file(arguments.text("--raw", ""));
    const std::string& topic = arguments.rest()[1];
    saying.writer_of(topic, find_codec(arguments.rest()[0]), qos_of(arguments));
    if (!arguments.has("--truncated")) {
        saying.say(topic, bytes);
        return;
    }
    const double rate_hz = arguments.number("--rate", 200);
    const auto start = Clock::now();
    for (std::size_t length = 1; length < bytes.size() && !is_told_to_end(); ++length) {
        sleep_until(after(start, static_cast<double>(length) / rate_hz));
        saying.say(topic, Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)));
    }
}

int say(int count, char** words) {
    const Arguments arguments(count, words, {"--stamp-now", "--truncated", "--until-read"},
                              {"--domain", "--qos", "--durability", "--depth", "--readers", "--wait",
                               "--settle", "--linger", "--rate", "--repeat", "--frame", "--images", "--topic",
                               "--count", "--encoding", "--depth-m", "--raw"});
    Saying saying(settings_of(arguments));
    if (arguments.has("--images")) {
        say_images(arguments, saying);
    } else if (arguments.has("--raw")) {
        say_raw(arguments, saying);
    } else {
        say_lines(arguments, saying);
    }
    saying.end();
    return 0;
}

}  // namespace
}  // namespace octoskin::ros

int main(int count, char** words) {
    return octoskin::ros::run_program(count, words, octoskin::ros::kUsage, &octoskin::ros::say);
}
