// SPDX-License-Identifier: MIT
#include "core/files/sha256.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <vector>

#include "core/process/two_cores.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

constexpr std::uint64_t short_file = std::uint64_t{1} << 20;   // under 1 ms of hashing: no gain by a thread
constexpr std::size_t piece_bytes = std::size_t{1} << 18;      // by hand: stays in a cache
constexpr std::uint64_t most_behind = std::uint64_t{1} << 23;  // by hand: the system still has them at hand

constexpr std::uint64_t given_up = ~std::uint64_t{0};

}  // namespace

void HashBeside::update(std::string_view bytes) {
    at_ += bytes.size();
    if (!thread_.joinable()) {
        hash_.update(bytes);
        hashed_here_ += bytes.size();
        if (descriptor_ >= 0 && hashed_here_ >= short_file) begin_thread();
        return;
    }
    if (at_ - told_to_ < piece_bytes) return;
    told_to_ = at_;
    told_ = 2 * at_;
    told_.notify_one();
    for (std::uint64_t done = hashed_to_; done < at_ - std::min(at_, most_behind); done = hashed_to_)
        hashed_to_.wait(done);
}

std::string HashBeside::hex() {
    if (thread_.joinable()) {
        told_ = 2 * at_ + 1;
        told_.notify_one();
        thread_.join();
    }
    if (failed_) raise<FileError>("a file that was read cannot be read once more, for its hash");
    return hash_.hex();
}

HashBeside::~HashBeside() {
    if (!thread_.joinable()) return;
    told_ = given_up;
    told_.notify_one();
    thread_.join();
}

void HashBeside::begin_thread() {
    told_to_ = at_;
    told_ = 2 * at_;
    hashed_to_ = at_;
    try {
        if (cores_here() > 1) thread_ = std::thread([this] { hash_file(); });
    } catch (const std::system_error&) {  // no thread to be had: one will do
    }
    if (!thread_.joinable()) descriptor_ = -1;
}

void HashBeside::hash_file() {
    std::vector<char> piece(piece_bytes);
    std::uint64_t place = hashed_to_, told = told_;
    while (told != given_up) {
        const std::uint64_t wanted = std::min<std::uint64_t>(told / 2 - place, piece.size());
        if (wanted > 0) {
            const ssize_t got = ::pread(descriptor_, piece.data(), wanted, static_cast<off_t>(place));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) break;
            hash_.update({piece.data(), static_cast<std::size_t>(got)});
            place += static_cast<std::uint64_t>(got);
            hashed_to_ = place;
            hashed_to_.notify_one();
        } else if (told % 2 == 1) {
            return;
        } else {
            told_.wait(told);
        }
        told = told_;
    }
    // Nobody waits for what will not come.
    failed_ = true;
    hashed_to_ = given_up;
    hashed_to_.notify_one();
}

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
