// SHA-256 (FIPS 180-4) of bytes that come in parts.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace octoskin {

class Sha256 {
  public:
    Sha256();
    ~Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;

    void add(std::string_view bytes);
    /// The length, then the bytes: so that two fields differ from the same bytes divided otherwise.
    void add_field(std::string_view bytes);
    /// 64 hexadecimal digits in lower case. Once only.
    [[nodiscard]] std::string hexadecimal();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

[[nodiscard]] std::string sha256_of(std::string_view bytes);

}  // namespace octoskin
