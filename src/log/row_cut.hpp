// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: which rows a range keeps, judged one after another, whatever the format.

#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "log/clock/time_axis.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

class RowCut {
  public:
    /// `whole`: how the times of the log are read. Throws DataError when there are none.
    RowCut(const ReadOptions& options, const Layout& whole);

    /// A log of dates or times of day says its first before its rows are judged.
    void first_stamp(std::optional<ClockTime> first) { axis_.first = first; }
    /// Whether the next row is inside. One whose time cannot be read goes with the row before. `time`: as in
    /// the file, less the origin; not asked where a rate was stated, for then rows tell the time. Throws
    /// UsageError at the first row where no range can hold.
    bool keeps(std::optional<double> time);
    [[nodiscard]] bool inside() const { return place_ == Place::inside; }
    [[nodiscard]] std::size_t kept() const { return kept_; }
    /// At the end of the log, or as soon as kept() is 2. Throws UsageError where fewer are kept.
    void require_rows() const;

    [[nodiscard]] const std::shared_ptr<RowsOutside>& outside() const { return outside_; }

  private:
    enum class Place { before, inside, after };
    void begin(double first_s);
    [[nodiscard]] Place place_of(double time_s) const;
    [[nodiscard]] std::string asked() const;

    std::string source_;
    TimeRange range_;
    std::optional<double> rate_hz_;
    double factor_ = 1.0;  ///< times in the file to seconds
    TimeAxis axis_;
    std::shared_ptr<RowsOutside> outside_ = std::make_shared<RowsOutside>();
    double from_s_ = -std::numeric_limits<double>::infinity(),
           to_s_ = std::numeric_limits<double>::infinity();
    Place place_ = Place::before;
    std::size_t rows_ = 0, kept_ = 0;
    std::optional<double> first_s_;
    double last_s_ = 0.0;
};

/// For a reader that is only asked how a log writes its times: what else it may lack is not its affair.
[[nodiscard]] ReadOptions clock_only(ReadOptions options);

/// Numbers in the file of what was kept of its lines or records. One thread may ask while another goes on.
class KeptNumbers {
  public:
    explicit KeptNumbers(std::size_t head = 0) : seen_(head), kept_(head) {}
    /// The next line or record.
    void add(bool kept);
    /// Both count from 1.
    [[nodiscard]] std::size_t in_file(std::size_t number) const;

  private:
    struct Hole {
        std::size_t kept, left_out;  ///< before what is behind it
    };
    mutable std::mutex mutex_;
    std::vector<Hole> holes_;
    std::size_t seen_, kept_;
};

}  // namespace ripplenotch
