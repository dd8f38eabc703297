// SPDX-License-Identifier: MIT
// ripplenotch design: the table of candidate notch filters.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/guarantee.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// Speed ranges as people type them: "18:180:18", "0.3rad/s:3rad/s", "18:36,36:60,60:100deg/s".

struct SpeedRange {
    DegPerSec from, to;
    std::optional<DegPerSec> width;  ///< of one band; empty for FROM:TO
};

// The unit that a number was written with. An exponent belongs to the number: "1e3" has none.
std::string_view unit_of(std::string_view text) {
    std::size_t end = text.size();
    while (end > 0 && (text[end - 1] < '0' || text[end - 1] > '9') && text[end - 1] != '.') --end;
    while (end < text.size() && text[end] == ' ') ++end;
    return text.substr(end);
}

std::vector<DegPerSec> parse_speeds(std::string_view text, std::string_view what) {
    const auto pieces = split(text, ':');
    const std::string_view last_unit = unit_of(pieces.back());
    std::size_t bare = 0;
    for (const auto piece : pieces) bare += unit_of(piece).empty() ? 1 : 0;
    // "0.3rad/s:3:0.3" is a trap: read as deg/s, the bare numbers would be fifty times too small.
    if (bare != 0 && bare != pieces.size() && (last_unit.empty() || bare != pieces.size() - 1)) {
        raise<UsageError>(
            "{}: '{}' mixes numbers with and without a unit; give each its unit, or only the last", what,
            text);
    }
    std::vector<DegPerSec> speeds;
    for (const auto piece : pieces) {
        const std::string with_unit =
            unit_of(piece).empty() ? fmt::format("{}{}", piece, last_unit) : std::string(piece);
        speeds.emplace_back(parse_quantity(with_unit, Dimension::speed, what));
    }
    return speeds;
}

// Reads FROM:TO or FROM:TO:WIDTH. Either each number has its unit, or only the last and it holds for all, or
// none and all are deg/s.
SpeedRange parse_speed_range(std::string_view text, std::string_view what) {
    const auto speeds = parse_speeds(text, what);
    if (speeds.size() != 2 && speeds.size() != 3) {
        raise<UsageError>("{}: '{}' is not FROM:TO:WIDTH, for example 18:180:18 (deg/s)", what, text);
    }
    SpeedRange range{speeds[0], speeds[1], std::nullopt};
    if (speeds.size() == 3) range.width = speeds[2];
    return range;
}

std::vector<std::pair<DegPerSec, DegPerSec>> parse_speed_bands(std::string_view text, std::string_view what) {
    std::vector<std::pair<DegPerSec, DegPerSec>> bands;
    for (const auto piece : split(text, ',')) {
        const auto speeds = parse_speeds(piece, what);
        if (speeds.size() != 2) {
            raise<UsageError>("{}: '{}' is not FROM:TO; a list reads 18:36,36:60,60:100 (deg/s)", what,
                              piece);
        }
        bands.emplace_back(speeds[0], speeds[1]);
    }
    return bands;
}

// "gear ratio 100, orders 1 and 2", "orders 200/turn and 400/turn of the joint".
std::string listed(const TableSpec& spec) {
    const std::vector<Order>& orders = spec.orders;
    std::string text =
        spec.gear_ratio == no_ratio ? "" : fmt::format("gear ratio {:.6g}, ", spec.gear_ratio.value());
    text += orders.size() == 1 ? "order " : "orders ";
    for (std::size_t i = 0; i < orders.size(); ++i) {
        if (i > 0) text += i + 1 == orders.size() ? " and " : ", ";
        text += order_text(orders[i], spec.gear_ratio);
    }
    return text + (spec.gear_ratio == no_ratio ? " of the joint" : "");
}

std::string plain(double value) { return fmt::format("{:.6g}", value); }

// Where no band applies, in the words of the rule.
std::string outside_sentence(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    const Band &first = table.bands().front(), &last = table.bands().back();
    const auto by_rule = [](OutsideRule rule, std::string pass, std::string hold, std::string fade) {
        return rule == OutsideRule::pass ? pass : rule == OutsideRule::hold ? hold : fade;
    };
    std::string text = first.from.value() > 0.0
                           ? fmt::format("At {} deg/s and below ", plain(first.from.value()))
                           : "At rest ";
    text += by_rule(spec.below, "the torque passes unfiltered", "the last active filter stays active",
                    fmt::format("band 1 fades out, down to {} deg/s", plain(0.5 * first.from.value())));
    text += fmt::format("; above {} deg/s ", plain(last.to.value()));
    text +=
        by_rule(spec.above, "it passes unfiltered.", fmt::format("band {} stays active.", last.number),
                fmt::format("band {} fades out, up to {} deg/s.", last.number, plain(1.5 * last.to.value())));
    const auto apart = [](const Band& a, const Band& b) { return a.to < b.from; };
    if (std::adjacent_find(table.bands().begin(), table.bands().end(), apart) != table.bands().end())
        text += " Between bands that do not touch, the rule for low speed holds.";
    return text;
}

// The least and the largest Q of all bands and orders.
std::pair<double, double> range_of_q(const CandidateTable& table) {
    double least = table.bands().front().notches.front().notch.q, largest = least;
    for (const Band& band : table.bands()) {
        for (const CandidateNotch& notch : band.notches) {
            least = std::min(least, notch.notch.q);
            largest = std::max(largest, notch.notch.q);
        }
    }
    return {least, largest};
}

struct BandColumn {
    std::string title, unit;
    std::function<std::string(const Band&)> cell;
};

// Those that every table has, and Q where it differs: for each order, or one for all.
std::vector<BandColumn> columns_of(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    std::vector<BandColumn> columns;
    const auto add = [&](std::string title, std::string unit, const auto& cell) {
        columns.push_back({std::move(title), std::move(unit), cell});
    };
    const auto each_order = [&](std::string_view what, const std::string& unit, int decimals,
                                std::vector<double> Band::*values) {
        for (std::size_t i = 0; i < spec.orders.size(); ++i)
            add(fmt::format("{} {}", what, order_text(spec.orders[i], spec.gear_ratio)), unit,
                [=](const Band& band) { return fmt::format("{:.{}f}", (band.*values)[i], decimals); });
    };
    add("band", "", [](const Band& band) { return std::to_string(band.number); });
    add("speed", "deg/s",
        [](const Band& band) { return fmt::format("{:.5g}-{:.5g}", band.from.value(), band.to.value()); });
    for (std::size_t i = 0; i < spec.orders.size(); ++i)
        // A measured gear ratio makes 7.49999 of 7.5; the full digits are in the CSV and the JSON.
        add(order_in_words(spec.orders[i], spec.gear_ratio), "Hz",
            [i](const Band& band) { return fmt::format("{:.5g}", band.notches[i].notch.center.value()); });
    const auto [least_q, largest_q] = range_of_q(table);
    const std::size_t qs = least_q == largest_q ? 0 : one_q_a_band(table) ? 1 : spec.orders.size();
    for (std::size_t i = 0; i < qs; ++i)
        add(qs == 1 ? "Q" : "Q " + order_text(spec.orders[i], spec.gear_ratio), "",
            [i](const Band& band) { return fmt::format("{:.3g}", band.notches[i].notch.q); });
    add("DC delay", "ms",
        [](const Band& band) { return fmt::format("{:.1f}", 1e3 * band.dc_delay.value()); });
    add("settles", fmt::format("ms to {} %", plain(spec.settle_band_percent)),
        [](const Band& band) { return fmt::format("{:.0f}", 1e3 * band.settle.value()); });
    add("overshoot", "%", [](const Band& band) { return fmt::format("{:.1f}", band.overshoot_percent); });
    each_order("worst", "dB", 1, &Band::worst_attenuation_db);
    // Where the orders count by their amplitudes, which the single lines do not say.
    if (spec.amplitude_nm.size() > 1)
        add("together", "dB",
            [](const Band& band) { return fmt::format("{:.1f}", band.held_attenuation_db); });
    if (!spec.amplitude_nm.empty()) each_order("remaining", "Nm", 3, &Band::predicted_residual_nm);
    return columns;
}

std::string delay_sentence(std::span<const Band> bands) {
    const auto by_delay = [](const Band& a, const Band& b) { return a.dc_delay < b.dc_delay; };
    const auto [least, most] = std::minmax_element(bands.begin(), bands.end(), by_delay);
    const double min_ms = 1e3 * least->dc_delay.value(), max_ms = 1e3 * most->dc_delay.value();
    if (bands.size() == 1) return fmt::format("The torque lags by {:.1f} ms.", min_ms);
    if (max_ms - min_ms < 0.05) return fmt::format("The torque lags by {:.1f} ms in every band.", max_ms);
    return fmt::format("The torque lags by {:.1f} ms (band {}) to {:.1f} ms (band {}).", min_ms,
                       least->number, max_ms, most->number);
}

// What the table is for, one row a band, and sentences: the delays, what happens outside the bands, and what
// it was designed for.
std::string table_to_text(const CandidateTable& table, const DesignNote& note) {
    const TableSpec& spec = table.spec();
    const auto [least_q, largest_q] = range_of_q(table);
    std::string text = fmt::format(
        "Candidate notches for {}, at {} Hz: {} band{}, Q {} ({}), {}.\n\n", listed(spec),
        plain(spec.sample_rate.value()), table.bands().size(), table.bands().size() == 1 ? "" : "s",
        least_q == largest_q ? shortest(least_q) : fmt::format("{:.3g} to {:.3g}", least_q, largest_q),
        width_rule_name(spec.width),
        spec.depth_db >= infinite_depth_db ? "full null" : fmt::format("{} dB deep", plain(spec.depth_db)));
    TextRows rows(2 + table.bands().size());
    for (const BandColumn& column : columns_of(table)) {
        rows[0].push_back(column.title);
        rows[1].push_back(column.unit);
        for (std::size_t i = 0; i < table.bands().size(); ++i)
            rows[i + 2].push_back(column.cell(table.bands()[i]));
    }
    text += text_table(rows, "r");
    text += "\nWorst: the least attenuation of that order's line anywhere in the band";
    if (spec.ratio_error >= 5e-5)
        text += fmt::format(", the gear ratio being up to {} % off", percent_text(100.0 * spec.ratio_error));
    if (spec.hysteresis.value() > 0.0)
        text +=
            fmt::format(", and {} deg/s beyond it, the switching hysteresis", plain(spec.hysteresis.value()));
    text += ". ";
    if (spec.amplitude_nm.size() > 1)
        text += "Together: attenuation of all orders, weighted by their amplitudes.  ";
    if (!spec.amplitude_nm.empty()) text += "Remaining: largest amplitude of each order after the filter. ";
    text += delay_sentence(table.bands()) + "\n" + outside_sentence(table) + "\n";
    if (!note.reason.empty()) text += fmt::format("Chosen: {}.\n", note.reason);
    if (note.slowest) text += slowest_sentence(*note.max_delay, *note.slowest) + "\n";
    return text;
}

// One sentence for each band whose middle can be notched but which reaches beyond half the sample rate,
// where the line of the highest order comes back as an alias.
std::vector<std::string> alias_warnings(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    std::vector<std::string> warnings;
    for (const Band& band : table.bands()) {
        const Order highest = spec.orders.back();
        if (ripple_frequency(highest, spec.gear_ratio, band.to) < 0.5 * spec.sample_rate) continue;
        const double limit = 180.0 * spec.sample_rate.value() / (highest.value() * spec.gear_ratio.value());
        warnings.push_back(
            fmt::format("band {} ({}-{} deg/s): {} passes half the sample rate at {} deg/s and is seen at a "
                        "lower frequency above that",
                        band.number, plain(band.from.value()), plain(band.to.value()),
                        order_in_words(highest, spec.gear_ratio), plain(limit)));
    }
    return warnings;
}

// What the design command was asked for, and the table specification that follows from it and a joint.json.

struct DesignRequest {
    CommonOptions common;
    std::string joint;
    GearOptions gear;
    std::optional<double> depth_db, q;
    /// Goals, and only checks where bands and Q are stated.
    std::optional<double> min_attenuation_db;
    std::optional<Seconds> max_delay;
    std::optional<DegPerSec> hysteresis;
    std::vector<double> amplitudes_nm;
    std::optional<Hertz> sample_rate;
    std::optional<std::string> speed, bands;

    /// Something is left to the tool: it chooses bands, Q, or both.
    [[nodiscard]] bool has_goal() const { return (min_attenuation_db || max_delay) && !only_checks(); }
    /// Limits are what the stated table is held against.
    [[nodiscard]] bool only_checks() const {
        const bool widths = speed && std::count(speed->begin(), speed->end(), ':') > 1;
        return q && (bands || widths);
    }
};

// The spacing is that of the lowest order's centres, as the paper states its table: 5 Hz is 18 deg/s at
// 1:100.
DegPerSec width_of_spacing(Hertz spacing, const TableSpec& spec) {
    return DegPerSec(360.0 * spacing.value() / (spec.orders.front().value() * spec.gear_ratio.value()));
}

// Nobody wants bands of 17.9993 deg/s because the gear ratio is known to five digits.
DegPerSec two_digits(DegPerSec width) {
    return DegPerSec(*parse_number(fmt::format("{:.1e}", width.value())));
}

// Bands about 5 Hz apart in the lowest order, as the paper's, over the speeds at which the lines were seen.
std::vector<std::pair<DegPerSec, DegPerSec>> bands_seen(const DesignRequest& request, const TableSpec& spec,
                                                        const GearStatement& joint) {
    if (!(joint.fastest.value() > 0.0)) {
        raise<UsageError>("{} has no line that follows the speed; give --speed FROM:TO:WIDTH", joint.source);
    }
    const double width = two_digits(width_of_spacing(Hertz(5.0), spec)).value();
    double from = std::floor(joint.slowest.value());
    double to = joint.fastest.value();
    // A joint seen at one speed only gets one band around it.
    if (to - from < width) from = std::max(0.0, 0.5 * (from + to) - 0.5 * width);
    const double limit_deg_s =
        180.0 * spec.sample_rate.value() / (spec.orders.back().value() * spec.gear_ratio.value());
    const double wanted = std::max(1.0, std::ceil((to - from) / width - 1e-9));
    double count = wanted;
    while (count > 0.0 && from + (count - 0.5) * width >= limit_deg_s) count -= 1.0;
    if (count < 1.0) {
        raise<UsageError>(
            "{}: {} is not below half the sample rate, {} Hz, at {:.6g} deg/s, the slowest speed seen; "
            "choose lower --orders or --speed",
            joint.source, order_in_words(spec.orders.back(), spec.gear_ratio),
            shortest(0.5 * spec.sample_rate.value()), from + 0.5 * width);
    }
    if (count < wanted) {
        warn(request.common,
             fmt::format("{}: lines were seen up to {:.6g} deg/s, but from {:.6g} deg/s on {} is not below "
                         "half the sample rate; the bands end at {:.6g} deg/s",
                         joint.source, to, limit_deg_s, order_in_words(spec.orders.back(), spec.gear_ratio),
                         from + count * width));
    }
    to = from + count * width;
    return bands_by_spacing({DegPerSec(from), DegPerSec(to)}, DegPerSec(width));
}

std::vector<std::pair<DegPerSec, DegPerSec>> bands_of(const DesignRequest& request, const TableSpec& spec,
                                                      const std::optional<GearStatement>& joint) {
    if (request.bands) {
        if (request.speed) raise<UsageError>("--bands lists the bands; it cannot be combined with --speed");
        return parse_speed_bands(*request.bands, "--bands");
    }
    if (!request.speed) {
        if (joint) return bands_seen(request, spec, *joint);
        raise<UsageError>(
            "no speeds to design for; give --speed FROM:TO:WIDTH (18:180:18) or --bands FROM:TO,FROM:TO");
    }
    const SpeedRange range = parse_speed_range(*request.speed, "--speed");
    if (!range.width) {
        raise<UsageError>(
            "--speed {} does not state how wide a band is; write FROM:TO:WIDTH, or state what the table has "
            "to hold with --min-attenuation or --max-delay",
            *request.speed);
    }
    return bands_by_spacing({range.from, range.to}, *range.width);
}

void fill_gear_of_table(TableSpec& spec, const DesignRequest& request, const GearChoice& choice,
                        const std::optional<GearStatement>& joint) {
    const auto gear = choice.of();
    if (!gear) raise_no_gear("a table");
    say(request.common, gear_in_words(*gear));
    spec.gear_ratio = gear->ratio;
    spec.orders = gear->orders;
    spec.amplitude_nm = gear->amplitude_nm;
    if (!request.amplitudes_nm.empty()) {
        if (!std::is_sorted(request.gear.orders.begin(), request.gear.orders.end()))
            raise<UsageError>(
                "--amplitudes: one per order, lowest order first; write --orders in that sequence");
        spec.amplitude_nm = request.amplitudes_nm;
    }
    if (!request.sample_rate && !joint)
        raise<UsageError>("the sample rate is missing; give --sample-rate, for example 1kHz");
    spec.sample_rate = request.sample_rate ? *request.sample_rate : joint->sample_rate;
    if (joint) spec.ratio_error = joint->ratio_error;  // none of a ratio that was given
}

// FROM:TO alone, or nothing: then the goal decides how many bands there are.
bool leaves_bands(const DesignRequest& request) {
    if (!request.has_goal() || request.bands) return false;
    return !request.speed || !parse_speed_range(*request.speed, "--speed").width;
}

// Noise takes the speed back over an edge that it has passed only when it changes by twice the hysteresis. At
// six standard deviations a sample does so with a chance of 1e-5 (a difference of two normal variables),
// where the edge itself is crossed at the noise's own rate.
constexpr double hysteresis_in_noise = 3.0;

DegPerSec hysteresis_of(const DesignRequest& request, const std::optional<GearStatement>& joint) {
    if (request.hysteresis) return *request.hysteresis;
    if (!joint) return DegPerSec(0.0);
    return two_digits(hysteresis_in_noise * joint->velocity_noise);
}

// Without bands when they are left to a goal. Throws what GearChoice::of throws, and UsageError that names
// the option which is missing or wrong.
TableSpec design_spec(const DesignRequest& request, const GearChoice& gear) {
    const auto joint = gear.facts();
    TableSpec spec;
    fill_gear_of_table(spec, request, gear, joint);
    spec.hysteresis = hysteresis_of(request, joint);
    spec.q = request.q.value_or(spec.q);
    if (request.depth_db) spec.depth_db = *request.depth_db;
    if (!leaves_bands(request)) spec.bands = bands_of(request, spec, joint);
    return spec;
}

// All speeds at which lines were seen, as far as the highest order stays below half the sample rate.
std::pair<DegPerSec, DegPerSec> speeds_seen(const TableSpec& spec, const GearStatement& joint) {
    if (!(joint.fastest.value() > 0.0))
        raise<UsageError>("{} has no line that follows the speed; give --speed FROM:TO", joint.source);
    const double limit_deg_s =
        180.0 * spec.sample_rate.value() /
        (spec.orders.back().value() * spec.gear_ratio.value() * (1.0 + spec.ratio_error));
    double from = std::floor(joint.slowest.value()), to = std::ceil(joint.fastest.value());
    // A joint seen at one speed only gets a tenth to either side.
    if (to - from < 2.0) {
        from = *parse_number(fmt::format("{:.3g}", 0.9 * joint.slowest.value()));
        to = *parse_number(fmt::format("{:.3g}", 1.1 * joint.fastest.value()));
    }
    return {DegPerSec(std::max(from, 1.0)), DegPerSec(std::min(to, std::floor(0.99 * limit_deg_s)))};
}

// The goal, with the speeds to cover where `spec` has no bands.
DesignGoal design_goal(const DesignRequest& request, const TableSpec& spec, const GearChoice& gear) {
    const auto joint = gear.facts();
    DesignGoal goal;
    goal.min_attenuation_db = request.min_attenuation_db;
    goal.max_delay = request.max_delay;
    goal.q = request.q;
    if (!spec.bands.empty()) return goal;
    if (request.speed) {
        const SpeedRange range = parse_speed_range(*request.speed, "--speed");
        goal.from = range.from;
        goal.to = range.to;
    } else if (joint) {
        std::tie(goal.from, goal.to) = speeds_seen(spec, *joint);
    } else {
        raise<UsageError>(
            "no speeds to design for; give --speed FROM:TO (18:180) or --bands FROM:TO,FROM:TO");
    }
    return goal;
}

// The options that would give this table without a joint.json and without arithmetic.
std::string as_if_options(const TableSpec& spec) {
    const std::string bands = joined(spec.bands, ",", [](const auto& band) {
        return shortest(band.first.value()) + ":" + shortest(band.second.value());
    });
    std::string line = fmt::format(
        "{}--orders {} --sample-rate {}Hz --bands {}",
        spec.gear_ratio == no_ratio ? "" : fmt::format("--gear-ratio {} ", shortest(spec.gear_ratio.value())),
        orders_text(spec.orders, spec.gear_ratio, ","), shortest(spec.sample_rate.value()), bands);
    if (spec.hysteresis.value() > 0.0)
        line += fmt::format(" --hysteresis {}deg/s", shortest(spec.hysteresis.value()));
    if (!spec.amplitude_nm.empty()) line += " --amplitudes " + joined(spec.amplitude_nm, ",");
    return line;
}

// Limits that the caller set: what breaks them is said, and the table is written all the same.
std::vector<std::string> violations_of(const DesignRequest& request, const CandidateTable& table) {
    std::vector<std::string> sentences;
    if (!request.only_checks()) return sentences;
    for (const Band& band : table.bands()) {
        const std::string label =
            fmt::format("band {} ({:.6g}-{:.6g} deg/s)", band.number, band.from.value(), band.to.value());
        const double delay_ms = 1e3 * band.dc_delay.value();
        if (request.max_delay && band.dc_delay > *request.max_delay) {
            sentences.push_back(fmt::format("{} delays by {:.1f} ms, more than --max-delay {:.6g}ms", label,
                                            delay_ms, 1e3 * request.max_delay->value()));
        }
        for (std::size_t i = 0; request.min_attenuation_db && i < band.notches.size(); ++i) {
            const double worst_db = band.worst_attenuation_db[i];
            if (worst_db >= *request.min_attenuation_db) continue;
            sentences.push_back(
                fmt::format("{} attenuates {} by as little as {:.1f} dB, less than --min-attenuation {}dB",
                            label, order_in_words(band.notches[i].order, table.spec().gear_ratio), worst_db,
                            shortest(*request.min_attenuation_db)));
        }
    }
    return sentences;
}

struct Drawn {
    CandidateTable table;
    DesignNote note;
};

// By what the table has to hold, or as it was spelled out.
Drawn draw(const DesignRequest& request, const TableSpec& spec, const GearChoice& gear) {
    DesignNote note;
    note.gear = gear.of();
    if (!request.has_goal()) return {CandidateTable::design(spec), std::move(note)};
    const DesignGoal goal = design_goal(request, spec, gear);
    DesignChoice choice = design_for(spec, goal);
    note.min_attenuation_db = goal.min_attenuation_db;
    note.max_delay = goal.max_delay;
    note.reason = choice.reason;
    if (goal.max_delay) note.slowest = slowest_within(spec, *goal.max_delay);
    return {std::move(choice.table), std::move(note)};
}

Answer run_design(const DesignRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    GearOptions options = request.gear;
    if (!request.joint.empty()) {
        if (options.joint_file) raise<UsageError>("JOINT and --joint-file: give one of them");
        options.joint_file = request.joint;
    }
    const GearChoice gear(options);
    if (gear.joint()) provenance.inputs.push_back(input_record(gear.joint()->path));
    if (gear.joint() && options.ratio) {
        const std::string against = against_ratio(gear.joint()->found, GearRatio(*options.ratio));
        if (!against.empty()) warn(request.common, against);
    }
    const TableSpec spec = design_spec(request, gear);
    const auto drawn = std::make_shared<const Drawn>(draw(request, spec, gear));
    say(request.common, fmt::format("designed as if with {}", as_if_options(drawn->table.spec())));
    say_warnings(request.common, alias_warnings(drawn->table));
    const auto broken = violations_of(request, drawn->table);
    say_warnings(request.common, broken);
    return {.text = request.common.output.ends_with(".csv") ? table_to_csv(drawn->table)
                                                            : table_to_text(drawn->table, drawn->note),
            .document = [drawn, provenance] { return table_to_json(drawn->table, provenance, drawn->note); },
            .figure = [drawn] { return table_figure(drawn->table); },
            .provenance = provenance,
            .code = broken.empty() ? ExitCode::done : ExitCode::limit_violated};
}

std::function<Answer()> attach_design(Options& options) {
    auto request = std::make_shared<DesignRequest>();
    options.argument("JOINT", request->joint, false, "the same as --joint-file; - is standard input");
    attach_gear(options, request->gear);
    options.numbers("--amplitudes", request->amplitudes_nm, Dimension::torque,
                    "of the ripple, zero to peak, one per order (default: those in JOINT)");
    options.number("--sample-rate", request->sample_rate, Dimension::frequency,
                   "rate at which the filter will run");
    options.text("--speed", request->speed, "FROM:TO[:WIDTH]",
                 "bands of equal width in deg/s, e.g. 18:180:18; without WIDTH for a goal to divide");
    options.text("--bands", request->bands, "FROM:TO,...",
                 "bands one by one in deg/s, e.g. 18:36,36:60,60:100");
    options.number("--min-attenuation", request->min_attenuation_db, Dimension::decibel,
                   "choose bands and Q that attenuate every order by this at every speed, e.g. 20dB; where "
                   "both are stated, exit code 1 when an order is attenuated less");
    options.number("--hysteresis", request->hysteresis, Dimension::speed,
                   "hysteresis: the filter leaves a band only when the speed is this far outside it "
                   "(default: three times the noise of the speed in JOINT, else 0)");
    options.duration("--max-delay", request->max_delay,
                     "choose bands and Q whose DC delay is no longer, e.g. 20ms; where both are stated, exit "
                     "code 1 when a band's is");
    options.number(
        "--quality,--q", request->q, Dimension::none,
        "or --q: centre over -3 dB width (default: 0.25, the paper's twin-T, or what a goal takes)");
    options.number("--depth", request->depth_db, Dimension::decibel,
                   "attenuation at the centre; a full null when left out");
    attach_plot(options, request->common);
    attach_common(options, request->common, {"a table", ".txt .csv .json", true});
    return [request, &options] { return run_design(*request, options.command_line()); };
}

}  // namespace

const Command commands::design = {
    .name = "design",
    .summary = "the table of candidate notch filters",
    .description =
        "For each band of joint speed, one notch per order at the frequency f = order * gear ratio * speed / "
        "360 of the\nband's middle speed, with the delay, settling time and worst attenuation that it "
        "costs.\nTable 1 of the paper: ripplenotch design --gear-ratio 100 --orders 1,2 --sample-rate 1kHz "
        "--speed 18:180:18",
    .attach = attach_design,
};

}  // namespace ripplenotch
