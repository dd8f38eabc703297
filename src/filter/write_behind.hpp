// SPDX-License-Identifier: MIT
#pragma once
// Formatting and writing on a thread of its own, so that reading and filtering go on meanwhile. Half the work
// of filtering a text log is writing numbers.

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// Hands blocks to a writer in order, at most one ahead of it, so memory stays bounded. Bytes are those of
/// the writer alone. What the writer throws is thrown by the next call here.
class WriteBehind {
  public:
    explicit WriteBehind(LogWriter& writer);
    /// Waits for the writer; throws nothing.
    ~WriteBehind();
    WriteBehind(const WriteBehind&) = delete;
    WriteBehind& operator=(const WriteBehind&) = delete;

    /// Takes the contents of both and gives back used ones, whose memory can be filled again.
    void write(RowBlock& block, std::vector<double>& torque_nm);
    /// After the last block: everything is with the writer, which the caller may finish.
    void join();

  private:
    void work();

    LogWriter& writer_;
    std::mutex mutex_;
    std::condition_variable changed_;
    RowBlock block_;  ///< handed over when full_, else used and free
    std::vector<double> torque_nm_;
    bool full_ = false, closing_ = false;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace ripplenotch
