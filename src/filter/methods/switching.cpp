// SPDX-License-Identifier: MIT
// The paper's method: a table of candidate filters and a supervisor that activates the one for the present
// speed (Kim, Kim, Song 2011, fig. 3 and 4, table 1).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "filter/method.hpp"
#include "filter/transitions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 3> rules = {"pass", "hold", "fade"};

constexpr std::array keys = {
    Key{.name = "table", .kind = KeyKind::text, .required = true, .help = "table.json, as design writes it"},
    Key{.name = "transition",
        .kind = KeyKind::choice,
        .default_text = default_transition,
        .choices = transition_names,
        .help = "what becomes of the filters' memories at a switch"},
    Key{.name = "crossfade",
        .dimension = Dimension::time,
        .default_text = "50ms",
        .at_least = 0.0,
        .at_most = 60.0,
        .help = "how long transition=crossfade blends"},
    Key{.name = "hysteresis",
        .dimension = Dimension::speed,
        .at_least = 0.0,
        .help = "hysteresis: the filter leaves a band only when the speed is this far outside it; else the "
                "table's"},
    Key{.name = "dwell",
        .dimension = Dimension::time,
        .default_text = "0",
        .at_least = 0.0,
        .at_most = 3600.0,
        .help = "shortest time between two switches"},
    Key{.name = "below",
        .kind = KeyKind::choice,
        .choices = rules,
        .help = "rule below the first band; else the table's"},
    Key{.name = "above",
        .kind = KeyKind::choice,
        .choices = rules,
        .help = "rule above the last band; else the table's"},
};

OutsideRule rule(const Settings& settings, std::string_view key, OutsideRule otherwise) {
    if (!settings.has(key)) return otherwise;
    const std::string text = settings.text(key);
    return text == "pass" ? OutsideRule::pass : text == "hold" ? OutsideRule::hold : OutsideRule::fade;
}

std::size_t samples(const Settings& settings, std::string_view key, Hertz sample_rate) {
    const double time_s = settings.number(key);
    // A time that is a whole number of samples but for rounding must not become one more.
    return static_cast<std::size_t>(std::ceil(time_s * sample_rate.value() - 1e-6));
}

// The supervisor of the switching filter: from the joint speed to the candidate that should be active (Kim,
// Kim, Song 2011, fig. 3 and 4), with the rules for speeds that no band covers.
class Supervisor {
  public:
    /// Throws UsageError when the hysteresis is negative.
    Supervisor(std::span<const Band> bands, const SwitchingDesign& design);

    /// The first sample of a run: takes the region of its speed, with no regard to the past.
    void start(double velocity_deg_s) noexcept;
    /// How many of these samples (after the one that was started or switched to) keep the active candidate
    /// and the region; speeds.size() when all do. They are then accounted for.
    [[nodiscard]] std::size_t stay(std::span<const double> velocity_deg_s) noexcept;
    /// The sample at which stay() stopped: enters its region. True when the candidate changed.
    bool move(double velocity_deg_s) noexcept;

    [[nodiscard]] int candidate() const noexcept { return candidate_; }
    [[nodiscard]] const SpeedRegion& region() const noexcept { return regions_[at_]; }

  private:
    [[nodiscard]] std::size_t find(double speed_deg_s) const noexcept;
    [[nodiscard]] int candidate_in(const SpeedRegion& region) const noexcept;
    void enter(std::size_t region) noexcept;

    std::vector<SpeedRegion> regions_;
    double hysteresis_deg_s_;
    std::size_t dwell_;
    std::size_t since_switch_ = 0;
    std::size_t at_ = 0;
    double low_ = 0.0, high_ = 0.0;  ///< stay while low_ < |v| <= high_
    int candidate_ = no_candidate;
};

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
    const auto stays = [&] {
        const double speed = std::abs(velocity_deg_s[count]);
        return speed > low_ && speed <= high_;
    };
    while (true) {
        while (count < velocity_deg_s.size() && stays()) ++count;
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

class SwitchingFilter final : public CausalFilter {
  public:
    SwitchingFilter(const CandidateTable& table, const SwitchingDesign& design)
        : supervisor_(table.bands(), design),
          transition_(make_transition(design.transition, table.bands(), design.crossfade_samples)) {
        for (const Band& band : table.bands()) numbers_.push_back(band.number);
    }

    void process(const Samples& in, std::span<double> out) override {
        std::size_t at = 0;
        while (at < out.size()) {
            if (!started_) {
                supervisor_.start(in.velocity_deg_s[at]);
                transition_->start(supervisor_.candidate(), in.torque_nm[at]);
                started_ = true;
                at += run(in, out, at, 1);
                continue;
            }
            const std::size_t most = std::min(out.size() - at, most_at_once);
            const std::size_t count = supervisor_.stay(in.velocity_deg_s.subspan(at, most));
            at += run(in, out, at, count);
            if (count == most) continue;
            const int before = supervisor_.candidate();
            const SpeedRegion left = supervisor_.region();
            if (supervisor_.move(in.velocity_deg_s[at])) {
                change(in, out, at, before, left);
            } else {
                run(in, out, at, 1);
            }
            ++at;
        }
        seen_ += out.size();
    }

    void restart() override { started_ = false; }
    [[nodiscard]] std::span<const Switch> switches() const override { return ledger_; }
    [[nodiscard]] std::size_t switch_count() const override { return switch_count_; }

  private:
    /// Scanned and then filtered; short, so that the processor fetches torques while speeds are scanned and
    /// the other way round.
    static constexpr std::size_t most_at_once = 512;

    // Samples of one region: the active candidate, mixed with the raw torque where the rule fades.
    std::size_t run(const Samples& in, std::span<double> out, std::size_t at, std::size_t count) {
        if (count == 0) return 0;
        transition_->run(in.torque_nm.subspan(at, count), out.subspan(at, count));
        const SpeedRegion& region = supervisor_.region();
        if (region.fades()) {
            for (std::size_t k = at; k < at + count; ++k) {
                out[k] = mixed(region, in.velocity_deg_s[k], in.torque_nm[k], out[k]);
            }
        }
        return count;
    }

    static double mixed(const SpeedRegion& region, double velocity_deg_s, double raw_nm, double filtered_nm) {
        const double share = region.share(std::abs(velocity_deg_s));
        return share == 1.0 ? filtered_nm : raw_nm + share * (filtered_nm - raw_nm);
    }

    void change(const Samples& in, std::span<double> out, std::size_t at, int before,
                const SpeedRegion& left) {
        const double velocity = in.velocity_deg_s[at], raw = in.torque_nm[at];
        const Change change = transition_->change(supervisor_.candidate(), raw);
        out[at] = mixed(supervisor_.region(), velocity, raw, change.now_nm);
        ++switch_count_;
        if (ledger_.size() == most_listed_switches) return;
        ledger_.push_back({.sample = seen_ + at,
                           .from_band = number(before),
                           .to_band = number(supervisor_.candidate()),
                           .speed_deg_s = velocity,
                           .jump_nm = out[at] - mixed(left, velocity, raw, change.unchanged_nm)});
    }

    [[nodiscard]] int number(int candidate) const {
        return candidate == no_candidate ? 0 : numbers_[static_cast<std::size_t>(candidate)];
    }

    Supervisor supervisor_;
    std::unique_ptr<Transition> transition_;
    std::vector<int> numbers_;  ///< band numbers by candidate
    std::vector<Switch> ledger_;
    std::size_t switch_count_ = 0;
    std::size_t seen_ = 0;
    bool started_ = false;
};

const CandidateTable& required(const CandidateTable* table) {
    if (table == nullptr) raise<UsageError>("method switching needs table=table.json, as design writes it");
    return *table;
}

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate,
                                    const CandidateTable* table) {
    const CandidateTable& candidates = required(table);
    return std::make_unique<SwitchingFilter>(candidates, switching_design(settings, sample_rate, candidates));
}

// Holding means the band that was passed through last: at a constant speed, the nearest one.
FrozenFilter frozen(const Settings& settings, Hertz sample_rate, const CandidateTable* table,
                    DegPerSec speed) {
    const CandidateTable& candidates = required(table);
    const SwitchingDesign used = switching_design(settings, sample_rate, candidates);
    const double at = std::abs(speed.value());
    const auto bands = candidates.bands();
    const auto regions = speed_regions(bands, used.below, used.above);
    const auto region =
        std::find_if(regions.begin(), regions.end(), [at](const SpeedRegion& r) { return at <= r.to_deg_s; });
    int candidate = region->candidate;
    if (region->holds) candidate = region == regions.begin() ? 0 : std::prev(region)->candidate;
    const double share = region->share(at);
    if (candidate == no_candidate || share == 0.0) return {{}, "no band: passes"};
    const Band& band = bands[static_cast<std::size_t>(candidate)];
    std::string note = fmt::format("band {}: {}-{} deg/s", band.number, shortest(band.from.value()),
                                   shortest(band.to.value()));
    if (region->holds) note += ", held outside it";
    if (share < 1.0)
        note += fmt::format(", faded to {:.3g} of the output (figures are for the full share)", share);
    return {band.cascade(), note};
}

constexpr double paper_spacing_hz = 5.0;  // of a table's centres, in the lowest order
constexpr int most_bands_tried = 60;
constexpr double highest_center = 0.45;  // of the rate at which the torque is updated

double two_digits(double value) { return *parse_number(fmt::format("{:.1e}", value)); }

Trials trials(const TrialConditions& log) {
    double width = two_digits(paper_spacing_hz / log.line(0, DegPerSec(1.0)).value());
    const double highest = highest_center * log.update_rate.value() /
                           log.line(log.gear.orders.size() - 1, DegPerSec(1.0)).value();
    const double top = std::min(log.fastest.value(), highest);
    while (top / width > most_bands_tried) width = two_digits(2.0 * width);
    const double from = width * std::max(1.0, std::floor(log.slowest.value() / width));
    const double bands = std::floor(top / width) - from / width + (top < highest ? 1.0 : 0.0);
    if (!(bands >= 1.0)) return {{}, "the speeds are too low for a table of notches"};
    TableSpec spec;
    spec.gear_ratio = log.gear.ratio;
    spec.orders = log.gear.orders;
    spec.sample_rate = log.sample_rate;
    spec.bands =
        bands_by_spacing({DegPerSec(from), DegPerSec(from + std::round(bands) * width)}, DegPerSec(width));
    Trials found{{{",table=table.json", spec}, {",table=table_narrow.json", spec}}};
    found.all.back().table->q = 1.0;
    return found;
}

// The state-variable form of the active band, or the sections of all bands where all of them run.
double multiplications(const Settings& settings, const CandidateTable* table) {
    const bool one_runs = settings.text("transition").starts_with("keep");
    constexpr double of_variable_section = 11.0;
    double most = 0.0, all = 0.0;
    for (const Band& band : required(table).bands()) {
        const auto sections = static_cast<double>(band.cascade().size());
        most = std::max(most, sections);
        all += sections;
    }
    return one_runs ? of_variable_section * most : section_multiplications * all;
}

}  // namespace

SwitchingDesign switching_design(const Settings& settings, Hertz sample_rate, const CandidateTable& table) {
    return {.below = rule(settings, "below", table.spec().below),
            .above = rule(settings, "above", table.spec().above),
            .hysteresis = settings.has("hysteresis") ? DegPerSec(settings.number("hysteresis"))
                                                     : table.spec().hysteresis,
            .dwell_samples = samples(settings, "dwell", sample_rate),
            .transition = settings.text("transition"),
            .crossfade_samples = samples(settings, "crossfade", sample_rate)};
}

const Method filter_methods::switching = {
    .name = "switching",
    .summary = "the notches of the table's band for the present speed (the paper's method)",
    .source = "Kim, Kim, Song 2011, fig. 3 and 4, table 1",
    .noun = "a table of notches",
    .keys = keys,
    .needs_table = true,
    .start = start,
    .frozen = frozen,
    .trials = trials,
    .multiplications = multiplications,
};

}  // namespace ripplenotch
