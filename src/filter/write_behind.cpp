// SPDX-License-Identifier: MIT
#include "filter/write_behind.hpp"

#include <utility>

namespace ripplenotch {

WriteBehind::WriteBehind(LogWriter& writer) : writer_(writer), thread_([this] { work(); }) {}

WriteBehind::~WriteBehind() {
    {
        const std::lock_guard lock(mutex_);
        closing_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void WriteBehind::write(RowBlock& block, std::vector<double>& torque_nm) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !full_ || failure_ != nullptr; });
    if (failure_ != nullptr) std::rethrow_exception(failure_);
    std::swap(block_, block);
    std::swap(torque_nm_, torque_nm);
    full_ = true;
    lock.unlock();
    changed_.notify_all();
}

void WriteBehind::join() {
    {
        const std::lock_guard lock(mutex_);
        closing_ = true;
    }
    changed_.notify_all();
    thread_.join();
    if (failure_ != nullptr) std::rethrow_exception(failure_);
}

void WriteBehind::work() {
    RowBlock block;
    std::vector<double> torque_nm;
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return full_ || closing_; });
        if (!full_) return;
        std::swap(block, block_);
        std::swap(torque_nm, torque_nm_);
        full_ = false;
        lock.unlock();
        changed_.notify_all();
        try {
            writer_.write(block, torque_nm);
        } catch (...) {
            lock.lock();
            failure_ = std::current_exception();
            lock.unlock();
            changed_.notify_all();
            return;
        }
        lock.lock();
    }
}

}  // namespace ripplenotch
