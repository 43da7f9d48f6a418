#include "host/bridge/dds/dds_topics.hpp"

#include <utility>

namespace octoskin::dds {
namespace {

class DdsTopic final : public bridge::TopicWriter {
  public:
    DdsTopic(const Participant& participant, std::string topic, const ros::TypeName& type,
             const ros::Qos& qos, Writer writer)
        : participant_(participant),
          topic_(std::move(topic)),
          type_(type),
          qos_(qos),
          writer_(std::move(writer)) {}

    bool write(cdr::Bytes message, WallTime) override { return writer_.write(std::move(message)); }
    [[nodiscard]] std::uint32_t readers() const override { return writer_.readers(); }
    void forget_messages() override {
        writer_ = {};  // two writers of one topic would be two publishers
        if (auto writer = participant_.writer(topic_, type_, qos_)) writer_ = std::move(writer).value();
    }

  private:
    const Participant& participant_;
    std::string topic_;
    ros::TypeName type_;
    ros::Qos qos_;
    Writer writer_;
};

}  // namespace

Result<std::unique_ptr<bridge::TopicWriter>, Error> Topics::writer(const std::string& topic,
                                                                   const ros::TypeName& type,
                                                                   const ros::Qos& qos) {
    auto writer = participant_.writer(topic, type, qos);
    if (!writer) return unexpected(writer.error());
    return std::unique_ptr<bridge::TopicWriter>(
        std::make_unique<DdsTopic>(participant_, topic, type, qos, std::move(writer).value()));
}

}  // namespace octoskin::dds
