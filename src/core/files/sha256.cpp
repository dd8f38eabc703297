// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nettle/sha2.h>

#include <array>
#include <vector>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

struct Sha256::Context {
    sha256_ctx state;
};

Sha256::Sha256() : context_(std::make_unique<Context>()) { sha256_init(&context_->state); }

Sha256::~Sha256() = default;

void Sha256::update(std::string_view bytes) {
    sha256_update(&context_->state, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

std::string Sha256::hex() {
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    sha256_digest(&context_->state, digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t byte : digest) text += fmt::format("{:02x}", byte);
    return text;
}

std::string sha256_of_file(const std::string& path) {
    ByteSource source(path);
    Sha256 hash;
    std::vector<char> buffer(std::size_t{1} << 20);
    while (const std::size_t size = source.read(buffer.data(), buffer.size())) {
        hash.update({buffer.data(), size});
    }
    return hash.hex();
}

}  // namespace ripplenotch
