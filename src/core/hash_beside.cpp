// SPDX-License-Identifier: MIT
#include "core/hash_beside.hpp"

#include <system_error>
#include <utility>

#include "core/two_cores.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t short_file = std::size_t{4} << 20;  // 2 ms of hashing: a thread would gain nothing
constexpr std::size_t handed_over_at = std::size_t{1} << 18;

}  // namespace

void HashBeside::update(std::string_view bytes) {
    if (!thread_.joinable()) {
        hash_.update(bytes);
        hashed_here_ += bytes.size();
        if (beside_ && hashed_here_ >= short_file) begin_thread();
        return;
    }
    filling_ += bytes;
    if (filling_.size() >= handed_over_at) hand_over();
}

std::string HashBeside::hex() {
    if (thread_.joinable()) {
        hand_over();
        thread_.request_stop();
        thread_.join();
    }
    return hash_.hex();
}

void HashBeside::begin_thread() {
    try {
        if (cores_here() > 1)
            thread_ = std::jthread([this](const std::stop_token& ended) { hash_pieces(ended); });
    } catch (const std::system_error&) {  // no thread to be had: one will do
    }
    beside_ = false;
}

void HashBeside::hand_over() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !busy_; });
    std::swap(filling_, handed_over_);
    filling_.clear();
    busy_ = true;
    changed_.notify_all();
}

void HashBeside::hash_pieces(const std::stop_token& ended) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, ended, [&] { return busy_; })) {
        lock.unlock();
        hash_.update(handed_over_);
        lock.lock();
        busy_ = false;
        changed_.notify_all();
    }
}

}  // namespace ripplenotch
