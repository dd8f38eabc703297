// SPDX-License-Identifier: MIT
#include "log/pieces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/process/heap.hpp"
#include "ripplenotch/log/passes.hpp"

namespace ripplenotch {
namespace {

// Few and long: half a minute at 1 kHz, in which a slow joint still turns and lines stand apart.
constexpr std::size_t most_pieces = 16;
// A million rows of time, speed, torque and position: less than what then looks at the pieces takes.
constexpr std::size_t most_bytes_kept = std::size_t{32} << 20;

/// Takes the rows of its pieces out of rows that go by.
class PieceTaker {
  public:
    PieceTaker(std::size_t rows, std::size_t most_rows, Trace& trace)
        : rows_(rows), in_piece_(std::max<std::size_t>(1, most_rows / most_pieces)), trace_(trace) {
        for (auto* column : {&trace.time_s, &trace.velocity_deg_s, &trace.torque_nm})
            column->reserve(in_piece_ * most_pieces);
    }

    void add(const TraceView& rows) {
        const std::size_t first = at_, end = at_ + rows.size();
        at_ = end;
        for (; piece_ < most_pieces; ++piece_) {
            const std::size_t from = std::max(first, begin_of(piece_)), to = std::min(end, end_of(piece_));
            if (from < to) take(rows, from - first, to - from, from == begin_of(piece_));
            if (end_of(piece_) > end) return;
        }
    }

  private:
    [[nodiscard]] std::size_t begin_of(std::size_t piece) const {
        return (rows_ - in_piece_) / (most_pieces - 1) * piece;
    }
    [[nodiscard]] std::size_t end_of(std::size_t piece) const { return begin_of(piece) + in_piece_; }

    void take(const TraceView& rows, std::size_t first, std::size_t count, bool begins_piece) {
        const bool begins_run = begins_piece || (first == 0 && !rows.run_starts.empty());
        if (begins_run && trace_.size() > 0) trace_.run_starts.push_back(trace_.size());
        const TraceView part = rows.part(first, count);
        const auto append = [](std::vector<double>& to, std::span<const double> from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(trace_.time_s, part.time_s);
        append(trace_.velocity_deg_s, part.velocity_deg_s);
        append(trace_.torque_nm, part.torque_nm);
        if (part.has_position()) trace_.position_deg.reserve(in_piece_ * most_pieces);
        append(trace_.position_deg, part.position_deg);
    }

    std::size_t rows_, in_piece_;
    Trace& trace_;
    std::size_t at_ = 0, piece_ = 0;
};

}  // namespace

std::optional<Log> read_pieces(const std::shared_ptr<const Spool>& log, const ReadOptions& options,
                               std::size_t most_rows, std::size_t joint) {
    grow_heap_in_large_pages();
    LogPasses passes(log, options, joint);
    passes.keep_rows(most_bytes_kept);
    passes.first([](const TraceView&) {});
    if (passes.facts().rows <= most_rows) return std::nullopt;
    Log part;
    PieceTaker taker(passes.facts().rows, most_rows, part.trace);
    passes.second([&](const TraceView& rows) { taker.add(rows); });
    const LogFacts& facts = passes.facts();
    part.layout = passes.layout();
    part.layout.chosen = part.layout.all_chosen()[joint];
    part.layout.others.clear();
    part.trace.source = part.layout.source;
    part.trace.joint = part.layout.chosen.joint;
    part.trace.sample_rate = facts.sample_rate;
    part.recording = passes.recording();
    part.recording.looked_at = LookedAt{part.trace.size(), most_pieces};
    part.recording.warnings.push_back(
        {"looked at in part",
         fmt::format(
             "{}: of {} rows {} are looked at, in {} pieces, evenly spread; --from and --to take a part of "
             "the log whole",
             part.layout.source, facts.rows, part.trace.size(), most_pieces),
         true});
    part.held_bad_values = facts.held_bad_values;
    part.clock_factor = facts.clock_factor;
    part.position_range_deg = facts.position_range_deg;
    return part;
}

}  // namespace ripplenotch
