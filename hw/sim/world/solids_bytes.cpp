#include "hw/sim/world/solids_bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace octoskin::sim {
namespace {

constexpr std::string_view kMark = "octoskin-solids/4\n";
enum class Kind : std::uint8_t { solids = 1, error = 2 };

class Writer {
  public:
    template <class Number>
    void put(Number number) {
        bytes_.append(reinterpret_cast<const char*>(&number), sizeof(number));
    }
    void put_text(std::string_view text) {
        put(static_cast<std::uint64_t>(text.size()));
        bytes_.append(text);
    }
    /// Eigen's vectors of three are three consecutive numbers in memory.
    template <class Vector>
    void put_vectors(const std::vector<Vector>& vectors) {
        static_assert(sizeof(Vector) == 3 * sizeof(typename Vector::Scalar));
        put(static_cast<std::uint64_t>(vectors.size()));
        bytes_.append(reinterpret_cast<const char*>(vectors.data()), vectors.size() * sizeof(Vector));
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

  private:
    std::string bytes_{kMark};
};

/// Checks every count against the remaining bytes before it allocates.
class Reader {
  public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {
        is_whole_ = bytes_.starts_with(kMark);
        bytes_.remove_prefix(is_whole_ ? kMark.size() : 0);
    }

    template <class Number>
    Number take() {
        Number number{};
        if (const char* const from = take_bytes(1, sizeof(number)))
            std::memcpy(&number, from, sizeof(number));
        return number;
    }
    std::string take_text() {
        const auto size = take<std::uint64_t>();
        const char* const from = take_bytes(size, 1);
        return from == nullptr ? "" : std::string(from, size);
    }
    template <class Vector>
    std::vector<Vector> take_vectors() {
        const auto count = take<std::uint64_t>();
        const char* const from = take_bytes(count, sizeof(Vector));
        if (from == nullptr) return {};
        std::vector<Vector> vectors(count);
        if (count > 0) std::memcpy(static_cast<void*>(vectors.data()), from, count * sizeof(Vector));
        return vectors;
    }
    [[nodiscard]] bool is_whole() const { return is_whole_; }
    [[nodiscard]] bool is_at_end() const { return is_whole_ && bytes_.empty(); }

  private:
    const char* take_bytes(std::uint64_t count, std::size_t size) {
        is_whole_ = is_whole_ && count <= bytes_.size() / size;
        if (!is_whole_) return nullptr;
        const char* const from = bytes_.data();
        bytes_.remove_prefix(static_cast<std::size_t>(count) * size);
        return from;
    }

    std::string_view bytes_;
    bool is_whole_ = true;
};

bool has_its_corners(const Solid& solid) {
    const auto count = static_cast<std::int64_t>(solid.vertices.size());
    return std::ranges::all_of(solid.triangles, [count](const Eigen::Vector3i& triangle) {
        return triangle.minCoeff() >= 0 && triangle.maxCoeff() < count;
    });
}

Solid take_solid(Reader& reader) {
    Solid solid;
    solid.name = reader.take_text();
    solid.model = reader.take_text();
    solid.vertices = reader.take_vectors<Eigen::Vector3d>();
    solid.triangles = reader.take_vectors<Eigen::Vector3i>();
    solid.is_closed = reader.take<std::uint8_t>() != 0;
    return solid;
}

}  // namespace

std::string to_bytes(const SolidsOrError& solids) {
    Writer writer;
    if (!solids) {
        writer.put(Kind::error);
        const Error& error = solids.error();
        writer.put(error.code);
        for (const std::string& text : {error.key, error.what, error.value, error.remedy})
            writer.put_text(text);
        return writer.take();
    }
    writer.put(Kind::solids);
    writer.put(static_cast<std::uint64_t>(solids->warnings.size()));
    for (const std::string& warning : solids->warnings) writer.put_text(warning);
    writer.put_text(solids->written_out);
    writer.put(static_cast<std::uint64_t>(solids->meshes.size()));
    for (const std::string& mesh : solids->meshes) writer.put_text(mesh);
    writer.put(static_cast<std::uint64_t>(solids->solids.size()));
    for (const Solid& solid : solids->solids) {
        writer.put_text(solid.name);
        writer.put_text(solid.model);
        writer.put_vectors(solid.vertices);
        writer.put_vectors(solid.triangles);
        writer.put(static_cast<std::uint8_t>(solid.is_closed));
    }
    return writer.take();
}

std::optional<SolidsOrError> from_bytes(std::string_view bytes) {
    Reader reader(bytes);
    const auto kind = reader.take<Kind>();
    if (kind == Kind::error) {
        Error error;
        error.code = reader.take<ErrorCode>();
        for (std::string* text : {&error.key, &error.what, &error.value, &error.remedy})
            *text = reader.take_text();
        const bool is_known = static_cast<std::size_t>(error.code) < kErrorMeanings.size();
        if (!reader.is_at_end() || !is_known) return std::nullopt;
        return SolidsOrError(unexpected(std::move(error)));
    }
    if (kind != Kind::solids) return std::nullopt;
    SolidsOfFile read;
    for (auto left = reader.take<std::uint64_t>(); left > 0 && reader.is_whole(); --left)
        read.warnings.push_back(reader.take_text());
    read.written_out = reader.take_text();
    for (auto left = reader.take<std::uint64_t>(); left > 0 && reader.is_whole(); --left)
        read.meshes.push_back(reader.take_text());
    for (auto left = reader.take<std::uint64_t>(); left > 0; --left) {
        Solid solid = take_solid(reader);
        if (!reader.is_whole() || !has_its_corners(solid)) return std::nullopt;
        read.solids.push_back(std::move(solid));
    }
    if (!reader.is_at_end()) return std::nullopt;
    return SolidsOrError(std::move(read));
}

}  // namespace octoskin::sim
