#include "host/bridge/dds/raw_type.hpp"

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <memory>
#include <utility>

namespace octoskin::dds {
namespace {

struct RawType : ddsi_sertype {
    std::size_t bytes_max = 0;  ///< of a received sample
};

std::size_t bytes_max_of(const ddsi_sertype* type) {
    return static_cast<const RawType*>(type)->bytes_max;
}

HostTime monotonic_time() noexcept {
    timespec now{};
    (void)::clock_gettime(CLOCK_MONOTONIC, &now);
    return {std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec};
}

struct RawSample : ddsi_serdata {
    /// Padded with zeros to a multiple of four: Cyclone reads as far.
    cdr::Bytes bytes;
    std::size_t size = 0;
    HostTime arrived = monotonic_time();
    std::int64_t number = 0;

    RawSample(const ddsi_sertype* of, ddsi_serdata_kind kind_in, cdr::Bytes bytes_in)
        : bytes(std::move(bytes_in)), size(bytes.size()) {
        ddsi_serdata_init(this, of, kind_in);
        hash = of->serdata_basehash;  // without a key there is one instance
        bytes.resize((size + 3) / 4 * 4);
    }
};

const RawSample& raw(const ddsi_serdata* sample) {
    return *static_cast<const RawSample*>(sample);
}

/// Cyclone calls these from C: no exception may leave. Null: the sample is dropped.
ddsi_serdata* make(const ddsi_sertype* type, ddsi_serdata_kind kind, auto fill) noexcept {
    try {
        cdr::Bytes bytes;
        fill(bytes);
        return new RawSample(type, kind, std::move(bytes));
    } catch (const std::exception&) {
        return nullptr;
    }
}

bool has_equal_key(const ddsi_serdata*, const ddsi_serdata*) {
    return true;
}

std::uint32_t size_of(const ddsi_serdata* sample) {
    return static_cast<std::uint32_t>(raw(sample).size);
}

/// From the message that the fragment came with; Cyclone has put it into this machine's byte order.
std::int64_t number_in(const nn_rdata& fragment) {
    Data_DataFrag_common message;
    std::memcpy(&message, NN_RMSG_PAYLOADOFF(fragment.rmsg, NN_RDATA_SUBMSG_OFF(&fragment)), sizeof(message));
    return (std::int64_t{message.writerSN.high} << 32U) | message.writerSN.low;
}

/// Fragments may overlap.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
    if (size > bytes_max_of(type)) return nullptr;
    const std::int64_t number = number_in(*fragment);
    ddsi_serdata* const made = make(type, kind, [&](cdr::Bytes& bytes) {
        bytes.resize(size);
        std::size_t at = 0;
        for (; fragment != nullptr; fragment = fragment->nextfrag) {
            const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
            if (end <= at) continue;
            const unsigned char* const payload =
                NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
            std::memcpy(bytes.data() + at, payload + (at - fragment->min), end - at);
            at = end;
        }
    });
    if (made != nullptr) static_cast<RawSample*>(made)->number = number;
    return made;
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
    if (size > bytes_max_of(type)) return nullptr;
    return make(type, kind, [&](cdr::Bytes& bytes) {
        for (const ddsrt_iovec_t& piece : std::span(pieces, count)) {
            const auto* const begin = static_cast<const std::uint8_t*>(piece.iov_base);
            bytes.insert(bytes.end(), begin, begin + std::min(piece.iov_len, size - bytes.size()));
        }
    });
}

ddsi_serdata* without_content(const ddsi_sertype* type, const ddsi_keyhash*) {
    return make(type, SDK_KEY, [](cdr::Bytes&) {});
}

ddsi_serdata* from_bytes(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
    return make(type, kind, [&](cdr::Bytes& bytes) { bytes = *static_cast<const cdr::Bytes*>(sample); });
}

void copy_out(const ddsi_serdata* sample, std::size_t from, std::size_t size, void* to) {
    std::memcpy(to, raw(sample).bytes.data() + from, size);
}

ddsi_serdata* lend(const ddsi_serdata* sample, std::size_t from, std::size_t size, ddsrt_iovec_t* piece) {
    piece->iov_base = const_cast<std::uint8_t*>(raw(sample).bytes.data() + from);
    piece->iov_len = size;
    return ddsi_serdata_ref(sample);
}

void take_back(ddsi_serdata* sample, const ddsrt_iovec_t*) {
    ddsi_serdata_unref(sample);
}

bool to_bytes(const ddsi_serdata* sample, void* to, void**, void*) {
    try {
        const auto bytes = bytes_of(sample);
        static_cast<cdr::Bytes*>(to)->assign(bytes.begin(), bytes.end());
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

ddsi_serdata* to_untyped(const ddsi_serdata* sample) {
    ddsi_serdata* const key = without_content(sample->type, nullptr);
    if (key != nullptr) key->type = nullptr;
    return key;
}

bool untyped_to_bytes(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
    return true;
}

void free_sample(ddsi_serdata* sample) {
    delete static_cast<RawSample*>(sample);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* sample, char* text, std::size_t size) {
    return static_cast<std::size_t>(std::snprintf(text, size, "%zu bytes", raw(sample).size));
}

void key_hash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
    *hash = {};
}

const ddsi_serdata_ops kSampleOperations = {
    .eqkey = has_equal_key,
    .get_size = size_of,
    .from_ser = from_fragments,
    .from_ser_iov = from_pieces,
    .from_keyhash = without_content,
    .from_sample = from_bytes,
    .to_ser = copy_out,
    .to_ser_ref = lend,
    .to_ser_unref = take_back,
    .to_sample = to_bytes,
    .to_untyped = to_untyped,
    .untyped_to_sample = untyped_to_bytes,
    .free = free_sample,
    .print = print,
    .get_keyhash = key_hash,
#ifdef DDS_HAS_SHM
    .get_sample_size = nullptr,
    .from_iox_buffer = nullptr,
#endif
};

void free_type(ddsi_sertype* type) {
    ddsi_sertype_fini(type);
    delete static_cast<RawType*>(type);
}

void clear(const ddsi_sertype*, void* samples, std::size_t count) {
    for (cdr::Bytes& bytes : std::span(static_cast<cdr::Bytes*>(samples), count)) bytes.clear();
}

/// Samples are taken as bytes, without Cyclone's own memory for them.
void no_samples(void** samples, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
    std::fill_n(samples, count, nullptr);
}
void free_no_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

bool is_equal(const ddsi_sertype* a, const ddsi_sertype* b) {
    return bytes_max_of(a) == bytes_max_of(b);  // the names were compared
}
std::uint32_t no_hash(const ddsi_sertype*) {
    return 0;
}

const ddsi_sertype_ops kTypeOperations = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free = free_type,
    .zero_samples = clear,
    .realloc_samples = no_samples,
    .free_samples = free_no_samples,
    .equal = is_equal,
    .hash = no_hash,
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = nullptr,
    .serialize_into = nullptr,
};

}  // namespace

ddsi_sertype* new_raw_type(const std::string& name, std::size_t bytes_max) {
    auto type = std::make_unique<RawType>();
    type->bytes_max = bytes_max;
    ddsi_sertype_init_flags(type.get(), name.c_str(), &kTypeOperations, &kSampleOperations,
                            DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
    type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
    return type.release();
}

ddsi_serdata* new_sample(const ddsi_sertype* type, cdr::Bytes bytes) {
    return new RawSample(type, SDK_DATA, std::move(bytes));
}

std::span<const std::uint8_t> bytes_of(const ddsi_serdata* sample) noexcept {
    return {raw(sample).bytes.data(), raw(sample).size};
}

HostTime arrival_of(const ddsi_serdata* sample) noexcept {
    return raw(sample).arrived;
}

std::int64_t number_of(const ddsi_serdata* sample) noexcept {
    return raw(sample).number;
}

void release(ddsi_serdata* sample) noexcept {
    ddsi_serdata_unref(sample);
}

}  // namespace octoskin::dds
