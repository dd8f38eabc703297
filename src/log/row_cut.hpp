// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: which rows a range keeps, judged one after another, whatever the format.

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "log/clock/choose_time.hpp"
#include "log/npy/npy_reader.hpp"
#include "log/npy/npy_writer.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

// Internal to the log room: the rows of a pass, kept for the next one as long as they are not too many.

/// Gives mapped memory back.
struct Unmapped {
    std::size_t bytes = 0;
    void operator()(double* numbers) const;
};

class KeptParts {
  public:
    /// Nothing is kept of more than so many numbers.
    explicit KeptParts(std::size_t most_numbers) : most_numbers_(most_numbers) {}

    void add(const TraceView& rows) {
        numbers_ += 4 * rows.size();
        if (numbers_ > most_numbers_) {
            parts_.clear();
            room_.reset();
            return;
        }
        parts_.push_back({kept(rows.time_s), kept(rows.velocity_deg_s), kept(rows.torque_nm),
                          kept(rows.position_deg), !rows.run_starts.empty()});
    }

    [[nodiscard]] bool whole() const { return numbers_ <= most_numbers_ && !parts_.empty(); }

    /// The parts as they were added, but for the rate.
    template <class Use>
    void replay(Hertz sample_rate, const Use& use) const {
        static constexpr std::array<std::size_t, 1> at_first_row = {0};
        for (const Part& part : parts_) {
            TraceView rows{sample_rate, part.time_s, part.velocity_deg_s, part.torque_nm, part.position_deg};
            if (part.begins_run) rows.run_starts = at_first_row;
            use(rows);
        }
    }

  private:
    struct Part {
        std::span<const double> time_s, velocity_deg_s, torque_nm, position_deg;
        bool begins_run;
    };
    /// A copy that stays where it is.
    [[nodiscard]] std::span<const double> kept(std::span<const double> numbers);

    std::size_t most_numbers_, numbers_ = 0;
    std::vector<Part> parts_;
    std::unique_ptr<double, Unmapped> room_;  ///< for all that may be kept, made when it is needed
    std::size_t used_ = 0;
};

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

/// The records of a log that --from and --to keep, as bytes, with what is needed to say where each stood.
class KeptRows {
  public:
    /// Reads the whole log. Throws DataError where no row stays.
    KeptRows(NpyReader& whole, const ReadOptions& options);

    /// The next bytes of the kept records; 0 at their end.
    [[nodiscard]] std::size_t read(char* into, std::size_t size) { return bytes_.read(into, size); }
    /// The row of the file in which a kept row stood.
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const { return numbers_.in_file(number); }
    [[nodiscard]] const RowCut& cut() const { return cut_; }

  private:
    RowCut cut_;
    KeptNumbers numbers_;
    TemporaryBytes bytes_;
};

// Internal to the log room: the rows of an array that a range keeps, as an array of their own.

/// LogFormat::cut of arrays. An array's head says how many rows follow, so the whole log is gone through
/// first, and what is kept waits in a temporary file.
[[nodiscard]] LogCut cut_npy(std::unique_ptr<ByteSource> source, std::string first_bytes,
                             const ReadOptions& options);

// Internal to the log room: the rows of a text log that a range keeps, as the bytes of a log of their own.

/// LogFormat::cut of text logs: its head, and the lines inside as they stand. Comments and blank lines go
/// with the row before them. Reads ahead until two rows are kept.
[[nodiscard]] LogCut cut_text(std::unique_ptr<ByteSource> source, std::string first_bytes,
                              const ReadOptions& options);

}  // namespace ripplenotch
