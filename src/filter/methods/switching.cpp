// SPDX-License-Identifier: MIT
// The paper's method: a table of candidate filters and a supervisor that activates the one for the present
// speed (Kim, Kim, Song 2011, fig. 3 and 4, table 1).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "design/switching_run.hpp"
#include "filter/method.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    Key{.name = "table", .kind = KeyKind::text, .required = true, .help = "table.json, as design writes it"},
    // Each choice has its row in docs/methods/switching.md.
    Key{.name = "transition",
        .default_text = default_transition,
        .choices = "parallel keep-state-variable crossfade",
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
    Key{.name = "below", .choices = "pass hold fade", .help = "rule below the first band; else the table's"},
    Key{.name = "above", .choices = "pass hold fade", .help = "rule above the last band; else the table's"},
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

class SwitchingFilter final : public CausalFilter {
  public:
    SwitchingFilter(const CandidateTable& table, const SwitchingDesign& design)
        : run_({}, sections_of(table), speed_regions(table.bands(), design.below, design.above), design) {
        for (const Band& band : table.bands()) numbers_.push_back(band.number);
    }

    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k) {
            bool changed = false;
            Switch change{.sample = seen_ + k, .speed_deg_s = in.velocity_deg_s[k]};
            out[k] = run_.next(in.torque_nm[k], std::abs(in.velocity_deg_s[k]),
                               [&](int before, double unchanged_nm) {
                                   changed = true;
                                   change.from_band = number(before);
                                   change.jump_nm = -unchanged_nm;
                               });
            if (!changed) continue;
            ++switch_count_;
            if (ledger_.size() == most_listed_switches) continue;
            change.to_band = number(run_.band());
            change.jump_nm += out[k];
            ledger_.push_back(change);
        }
        seen_ += out.size();
    }

    void restart() override { run_.restart(); }
    [[nodiscard]] std::span<const Switch> switches() const override { return ledger_; }
    [[nodiscard]] std::size_t switch_count() const override { return switch_count_; }

  private:
    using Run = SwitchingRun<Svf<Floating<double>>>;

    // Padded with neutral ones to equal length.
    static std::vector<std::vector<Run::rn_section>> sections_of(const CandidateTable& table) {
        std::size_t most = 0;
        for (const Band& band : table.bands()) most = std::max(most, band.notches.size());
        std::vector<std::vector<Run::rn_section>> bands;
        for (const Band& band : table.bands()) {
            auto& sections = bands.emplace_back(most, Svf<Floating<double>>::section(SvfSection{}));
            for (std::size_t i = 0; i < band.notches.size(); ++i)
                sections[i] =
                    Svf<Floating<double>>::section(svf_of(band.notches[i].notch, table.spec().sample_rate));
        }
        return bands;
    }
    [[nodiscard]] int number(int candidate) const {
        return candidate == no_candidate ? 0 : numbers_[static_cast<std::size_t>(candidate)];
    }

    Run run_;
    std::vector<int> numbers_;  ///< band numbers by candidate
    std::vector<Switch> ledger_;
    std::size_t switch_count_ = 0;
    std::size_t seen_ = 0;
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

// The state-variable form of the active band, or of all bands where all of them run.
double multiplications(const Settings& settings, const CandidateTable* table) {
    const bool one_runs = settings.text("transition").starts_with("keep");
    constexpr double of_variable_section = 11.0;
    double most = 0.0, all = 0.0;
    for (const Band& band : required(table).bands()) {
        const auto sections = static_cast<double>(band.cascade().size());
        most = std::max(most, sections);
        all += sections;
    }
    return of_variable_section * (one_runs ? most : all);
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
