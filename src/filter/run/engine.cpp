// SPDX-License-Identifier: MIT
#include "filter/run/engine.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "filter/method.hpp"
#include "filter/run/block_pipeline.hpp"
#include "log/account/account.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

namespace {

// Internal to the filter module: blocks of rows, one after another, through the filters of their joints.

/// The state of one pass over a log.
class StreamPass {
  public:
    StreamPass(Account& account, std::span<const JointRun> joints);

    /// Filters the block's joints into `torque_nm`. Throws DataError when time runs backward.
    void filter(const RowBlock& block, std::vector<std::vector<double>>& torque_nm);

    /// By joint, after the last block; `layout` as it stands then.
    [[nodiscard]] std::vector<StreamReport> reports(const Layout& layout) const;

  private:
    struct Lane {
        JointRun run;
        StreamReport report{};
        std::size_t rows = 0, rows_left_out = 0;
        JointsPosition position{};
        std::vector<double> torque_nm{};  ///< less the ripple of other joints
    };

    /// What else is known at the block's rows; empty where it is not.
    struct Known {
        std::span<const double> temperature_degc, other_ripple_nm;
    };
    void filter_part(const RowBlock& block, std::size_t joint, const RunPart& part, const Known& known,
                     std::vector<double>& torque_nm);
    /// `first`: the place of the rows in the log.
    static void meter_rows(const TraceView& rows, std::size_t first, bool begins_run,
                           std::span<const double> torque_nm, Lane& lane);
    static void note_switches(const RowBlock& block, Lane& lane);
    static void note_motion(const JointRows& rows, Lane& lane);

    Account& account_;
    std::vector<Lane> lanes_;
};

StreamPass::StreamPass(Account& account, std::span<const JointRun> joints) : account_(account) {
    for (const JointRun& run : joints) lanes_.push_back({run});
}

void StreamPass::filter(const RowBlock& block, std::vector<std::vector<double>>& torque_nm) {
    torque_nm.resize(lanes_.size());
    const std::span<const RunPart> parts = account_.add(block);
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        Lane& lane = lanes_[j];
        note_motion(block.joints[j], lane);
        torque_nm[j].resize(block.size());
        Known known;
        if (lane.run.temperature != nullptr)
            known.temperature_degc = lane.run.temperature->next(block.size());
        if (lane.run.other_ripple != nullptr)
            known.other_ripple_nm = lane.run.other_ripple->next(block.size());
        for (const RunPart& part : parts) filter_part(block, j, part, known, torque_nm[j]);
        lane.rows += block.size();
        lane.report.held_bad_values += block.held_bad_values;
    }
}

void StreamPass::filter_part(const RowBlock& block, std::size_t joint, const RunPart& part,
                             const Known& known, std::vector<double>& torque_nm) {
    Lane& lane = lanes_[joint];
    TraceView rows = view_of(block, joint, part.first, part.count);
    const std::span<double> out = std::span(torque_nm).subspan(part.first, part.count);
    if (!part.usable) {
        std::copy(rows.torque_nm.begin(), rows.torque_nm.end(), out.begin());
        lane.rows_left_out += part.count;
        return;
    }
    rows.position_deg = lane.position.of(account_.angle(joint), rows);
    if (part.begins_run && lane.rows + part.first > lane.rows_left_out) lane.run.filter->restart();
    const auto of_part = [&part](std::span<const double> values) {
        return values.empty() ? values : values.subspan(part.first, part.count);
    };
    std::span<const double> torque = rows.torque_nm;
    if (const auto ripple = of_part(known.other_ripple_nm); !ripple.empty()) {
        lane.torque_nm.assign(torque.begin(), torque.end());
        for (std::size_t k = 0; k < ripple.size(); ++k) lane.torque_nm[k] -= ripple[k];
        torque = lane.torque_nm;
    }
    lane.run.filter->process(
        {rows.velocity_deg_s, torque, rows.position_deg, of_part(known.temperature_degc)}, out);
    note_switches(block, lane);
    if (lane.run.meter != nullptr) meter_rows(rows, lane.rows + part.first, part.begins_run, out, lane);
}

// Stretches 0, 1, 3, 7, 15, ...: all of a short log.
bool in_measured_stretch(std::size_t row) {
    constexpr std::size_t stretch = 8192;  // chosen, not derived: several turns of a motor at most rates
    return std::has_single_bit(row / stretch + 1);
}

void StreamPass::meter_rows(const TraceView& rows, std::size_t first, bool begins_run,
                            std::span<const double> torque_nm, Lane& lane) {
    RippleMeter& meter = *lane.run.meter;
    if (begins_run) meter.split();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (lane.run.sparsely && !in_measured_stretch(first + k)) {
            if (in_measured_stretch(first + k - 1)) meter.split();
            continue;
        }
        const double* const position = rows.has_position() ? &rows.position_deg[k] : nullptr;
        const std::array torque = {rows.torque_nm[k], torque_nm[k]};
        meter.add(Seconds(rows.time_s[k]), rows.velocity_deg_s[k], position, torque);
    }
}

// A filter counts the rows it was given; people count those of the log.
void StreamPass::note_switches(const RowBlock& block, Lane& lane) {
    const auto switches = lane.run.filter->switches();
    std::vector<TimedSwitch>& listed = lane.report.switches;
    for (std::size_t i = listed.size(); i < switches.size(); ++i) {
        Switch change = switches[i];
        change.sample += lane.rows_left_out;
        listed.push_back({change, block.time_s[change.sample - lane.rows]});
    }
}

void StreamPass::note_motion(const JointRows& rows, Lane& lane) {
    StreamReport& report = lane.report;
    SpeedExtent range{report.slowest_deg_s, report.fastest_deg_s};
    if (lane.rows == 0 && !rows.velocity_deg_s.empty())
        range.slowest_deg_s = range.fastest_deg_s = std::abs(rows.velocity_deg_s.front());
    widen(range, rows.velocity_deg_s);
    report.slowest_deg_s = range.slowest_deg_s;
    report.fastest_deg_s = range.fastest_deg_s;
}

std::vector<StreamReport> StreamPass::reports(const Layout& layout) const {
    std::vector<StreamReport> reports;
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        StreamReport report = lanes_[j].report;
        report.recording = account_.recording(layout, j);
        report.switch_count = lanes_[j].run.filter->switch_count();
        reports.push_back(std::move(report));
    }
    return reports;
}

}  // namespace

Supervisor::Supervisor(std::span<const Band> bands, const SwitchingDesign& design)
    : regions_(speed_regions(bands, design.below, design.above)),
      hysteresis_deg_s_(design.hysteresis.value()),
      dwell_(design.dwell_samples) {}

std::size_t Supervisor::find(double speed_deg_s) const noexcept {
    const auto holds_speed = [speed_deg_s](const SpeedRegion& region) {
        return speed_deg_s <= region.to_deg_s;
    };
    const auto found = std::find_if(regions_.begin(), regions_.end(), holds_speed);
    // A speed that is not a number is in no region; the lowest is the one that does least.
    return found == regions_.end() ? 0 : static_cast<std::size_t>(found - regions_.begin());
}

int Supervisor::candidate_in(const SpeedRegion& region) const noexcept {
    return region.holds ? candidate_ : region.candidate;
}

void Supervisor::enter(std::size_t region) noexcept {
    at_ = region;
    low_ = regions_[at_].from_deg_s - hysteresis_deg_s_;
    high_ = regions_[at_].to_deg_s + hysteresis_deg_s_;
}

void Supervisor::start(double velocity_deg_s) noexcept {
    candidate_ = no_candidate;
    enter(find(std::abs(velocity_deg_s)));
    candidate_ = candidate_in(region());
    since_switch_ = dwell_;  // the first choice is no switch: it need not dwell
}

std::size_t Supervisor::stay(std::span<const double> velocity_deg_s) noexcept {
    std::size_t count = 0;
    while (true) {
        count += first_outside(velocity_deg_s.subspan(count), low_, high_);
        if (count == velocity_deg_s.size()) break;
        const bool must_dwell = since_switch_ + count < dwell_;
        const SpeedRegion& next = regions_[find(std::abs(velocity_deg_s[count]))];
        if (!must_dwell || candidate_in(next) == candidate_) break;
        ++count;
    }
    since_switch_ = std::min(since_switch_ + count, dwell_);
    return count;
}

bool Supervisor::move(double velocity_deg_s) noexcept {
    const std::size_t next = find(std::abs(velocity_deg_s));
    const int before = candidate_;
    candidate_ = candidate_in(regions_[next]);
    enter(next);
    if (candidate_ != before) {
        since_switch_ = std::min<std::size_t>(1, dwell_);
    } else {
        since_switch_ = std::min(since_switch_ + 1, dwell_);
    }
    return candidate_ != before;
}

std::optional<RunningDesign> running_design(const Method& method, const Settings& settings,
                                            Hertz sample_rate) {
    if (method.name == "tracking") return tracking_design(settings, sample_rate);
    if (method.name == "oscillator") return oscillator_design(settings, sample_rate);
    return std::nullopt;
}

namespace {

// Digits after the decimal mark of a number as it is written in a log.
int decimals_of(std::string_view number) {
    // Character by character: a cell is shorter than the set-up cost of a search for one of two.
    std::size_t mark = 0;
    while (mark < number.size() && number[mark] != '.' && number[mark] != ',') ++mark;
    if (mark == number.size()) return 0;
    std::size_t at = mark + 1;
    while (at < number.size() && number[at] >= '0' && number[at] <= '9') ++at;
    return static_cast<int>(std::min<std::size_t>(at - mark - 1, 17));
}

std::string per_cent(double share) { return percent_text(100.0 * share) + " %"; }

}  // namespace

void refuse_table_rate(const TableAndLogRate& rates, const std::string& source) {
    const auto [table, log] = rates;
    const double off = std::abs(log / table - 1.0);
    if (off <= rate_refused) return;
    raise<DataError>(
        "{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz, and its notches would be {} "
        "off; design "
        "the table with --sample-rate {:.6g}Hz, or state the log's true rate with --sample-rate",
        source, log.value(), table.value(), per_cent(off), log.value());
}

std::optional<std::string> table_rate_warning(const TableAndLogRate& rates, const std::string& source) {
    const auto [table, log] = rates;
    const double off = std::abs(log / table - 1.0);
    if (off <= rate_worth_a_word) return std::nullopt;
    return fmt::format(
        "{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz: its notches are {} off; design "
        "the table "
        "with --sample-rate {:.6g}Hz to have them right",
        source, log.value(), table.value(), per_cent(off), log.value());
}

std::optional<std::string> compare_table_rate(const TableAndLogRate& rates, const std::string& source) {
    refuse_table_rate(rates, source);
    return table_rate_warning(rates, source);
}

struct LogStream::State {
    std::unique_ptr<LogReader> reader;
    Opening opening;
    Account account;
};

LogStream::LogStream(std::unique_ptr<LogReader> reader, double gap_steps) {
    Opening opening = read_opening(*reader);
    Account account(reader->layout(), opening, gap_steps);
    account.clock().require();
    state_ = std::make_unique<State>(State{std::move(reader), std::move(opening), std::move(account)});
}

LogStream::~LogStream() = default;

LogStream::LogStream(LogStream&&) noexcept = default;

const LogReader& LogStream::reader() const { return *state_->reader; }

Hertz LogStream::design_rate() const { return state_->account.clock().nominal_rate(); }

std::optional<int> LogStream::torque_decimals() const {
    std::optional<int> decimals;
    for (std::size_t b = 0; b < state_->opening.blocks.size(); ++b) {
        const RowBlock& block = state_->opening.blocks[b];
        for (const JointRows& joint : block.joints) {
            const std::size_t count = std::min(state_->opening.counts[b], joint.torque_end.size());
            for (std::size_t k = 0; k < count; ++k) {
                const std::string_view cell =
                    std::string_view(block.bytes)
                        .substr(joint.torque_begin[k], joint.torque_end[k] - joint.torque_begin[k]);
                decimals = std::max(decimals.value_or(0), decimals_of(cell));
            }
        }
    }
    return decimals;
}

StreamReport LogStream::run(CausalFilter& filter, LogWriter* writer, RippleMeter* meter,
                            std::size_t threads) {
    const JointRun joint{&filter, meter};
    return std::move(run(std::span(&joint, 1), writer, threads).front());
}

std::vector<StreamReport> LogStream::run(std::span<const JointRun> joints, LogWriter* writer,
                                         std::size_t threads) {
    LogReader& reader = *state_->reader;
    Opening& opening = state_->opening;
    StreamPass pass(state_->account, joints);
    BlockSteps steps;
    steps.fetch = [&](BlockItem& item) {
        if (opening.blocks.empty()) return reader.fetch(item.block);
        item.block = std::move(opening.blocks.front());
        opening.blocks.pop_front();
        item.accepted = true;
        return true;
    };
    steps.parse = [&](BlockItem& item) { reader.parse(item.block); };
    steps.filter = [&](BlockItem& item) {
        if (!item.accepted) reader.accept(item.block);
        pass.filter(item.block, item.torque_nm);
    };
    steps.prepare = [&](BlockItem& item) {
        if (writer != nullptr) item.bytes = writer->prepare(item.block, item.torque_nm, item.room);
    };
    steps.put = [&](BlockItem& item) {
        if (writer != nullptr) writer->put(item.block, item.torque_nm, item.bytes);
        if (item.block.failure) std::rethrow_exception(item.block.failure);
    };
    run_blocks(steps, opening.whole_log ? 1 : threads);
    if (writer != nullptr) writer->finish();
    return pass.reports(reader.layout());
}

}  // namespace ripplenotch
