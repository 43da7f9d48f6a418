#include "host/io/digest/sha256.hpp"

#include <sha256.h>

#include <cstdint>

namespace octoskin {

struct Sha256::State {
    SHA256_CTX context;
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
    SHA256Init(&state_->context);
}

Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    SHA256Update(&state_->context, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

void Sha256::add_field(std::string_view bytes) {
    add(std::to_string(bytes.size()) + ' ');
    add(bytes);
}

std::string Sha256::hexadecimal() {
    std::string text(SHA256_DIGEST_STRING_LENGTH, '\0');
    SHA256End(&state_->context, text.data());
    text.resize(SHA256_DIGEST_STRING_LENGTH - 1);
    return text;
}

std::string sha256_of(std::string_view bytes) {
    Sha256 digest;
    digest.add(bytes);
    return digest.hexadecimal();
}

}  // namespace octoskin
