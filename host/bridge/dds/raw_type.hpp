// DDS samples as bytes: Cyclone DDS carries them without knowing their fields.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <span>
#include <string>

#include "common/time.hpp"
#include "host/bridge/cdr/cdr_writer.hpp"

struct ddsi_sertype;
struct ddsi_serdata;

namespace octoskin::dds {

/// A type of this DDS name for a topic, with one reference, which dds_create_topic_sertype() takes over.
/// Received samples of more than `bytes_max` are dropped. Throws std::bad_alloc.
[[nodiscard]] ddsi_sertype* new_raw_type(const std::string& name, std::size_t bytes_max);

/// A sample of the type with these bytes, the encoding's header included; it has one reference, which
/// dds_writecdr() takes over. Throws std::bad_alloc.
[[nodiscard]] ddsi_serdata* new_sample(const ddsi_sertype* type, cdr::Bytes bytes);

/// The bytes of a sample of a raw type. Valid as long as the sample.
[[nodiscard]] std::span<const std::uint8_t> bytes_of(const ddsi_serdata* sample) noexcept;
/// The writer numbers its samples from 1; 0: of a sample that did not come from the network.
/// When it arrived, or was made.
[[nodiscard]] HostTime arrival_of(const ddsi_serdata* sample) noexcept;
[[nodiscard]] std::int64_t number_of(const ddsi_serdata* sample) noexcept;

/// Releases one reference.
void release(ddsi_serdata* sample) noexcept;

}  // namespace octoskin::dds
