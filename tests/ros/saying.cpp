#include "tests/ros/saying.hpp"

#include <thread>

#include "tests/ros/output.hpp"

namespace octoskin::ros {

void sleep_until(Clock::time_point time) {
    while (!is_told_to_end() && Clock::now() < time) {
        std::this_thread::sleep_until(std::min(time, Clock::now() + std::chrono::milliseconds(50)));
    }
}

void sleep_for(double seconds) {
    sleep_until(after(Clock::now(), seconds));
}

dds::DataWriter& Saying::writer_of(const std::string& topic, const Codec& codec, const Qos& qos) {
    Said& said = said_[topic];
    if (said.writer == nullptr) {
        said.writer = participant_.add_writer(topic, codec, qos);
        wait_for_readers(topic, *said.writer);
    }
    return *said.writer;
}

void Saying::wait_for_readers(const std::string& topic, dds::DataWriter& writer) const {
    const auto end = after(Clock::now(), settings_.wait_seconds);
    dds::PublicationMatchedStatus status;
    do {
        writer.get_publication_matched_status(status);
        if (status.current_count >= settings_.readers) {
            break;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    } while (!is_told_to_end() && Clock::now() < end);
    if (status.current_count > 0) {
        sleep_for(settings_.settle_seconds);
    }
    print({{"event", "matched"}, {"topic", topic}, {"readers", status.current_count}});
}

void Saying::say(const std::string& topic, const Bytes& bytes) {
    Said& said = said_.at(topic);
    Bytes sample = bytes;  // Fast DDS takes no constant sample
    said.writer->write(&sample) ? ++said.samples : ++said.refused;
}

void Saying::end() {
    Json topics = Json::object();
    for (auto& [topic, said] : said_) {
        if (settings_.is_until_read) {
            said.writer->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(10, 0));
        }
        topics[topic] = {{"samples", said.samples}, {"refused", said.refused}};
    }
    sleep_until(Clock::now() +
                std::chrono::duration_cast<Clock::duration>(Seconds(settings_.linger_seconds)));
    print({{"event", "counts"}, {"topics", topics}});
}

}  // namespace octoskin::ros
