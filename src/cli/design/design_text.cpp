// SPDX-License-Identifier: MIT
#include "cli/design/design_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace {

std::string four(double value) { return fmt::format("{:.4g}", value); }

}  // namespace

std::string slowest_sentence(Seconds delay, DegPerSec slowest) {
    return fmt::format("Below {} deg/s no notch of Q 5 or less is within {} ms.", four(slowest.value()),
                       four(1e3 * delay.value()));
}

namespace {

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

}  // namespace

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

namespace {

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
    const std::string low = plain(first.from.value()), high = plain(last.to.value());
    std::string text = first.from.value() > 0.0 ? fmt::format("At {} deg/s and below ", low) : "At rest ";
    switch (spec.below) {
        case OutsideRule::pass:
            text += "the torque passes unfiltered";
            break;
        case OutsideRule::hold:
            text += "the last active filter stays active";
            break;
        case OutsideRule::fade:
            text += fmt::format("band 1 fades out, down to {} deg/s", plain(0.5 * first.from.value()));
            break;
    }
    text += fmt::format("; above {} deg/s ", high);
    switch (spec.above) {
        case OutsideRule::pass:
            text += "it passes unfiltered.";
            break;
        case OutsideRule::hold:
            text += fmt::format("band {} stays active.", last.number);
            break;
        case OutsideRule::fade:
            text +=
                fmt::format("band {} fades out, up to {} deg/s.", last.number, plain(1.5 * last.to.value()));
            break;
    }
    for (std::size_t i = 1; i < table.bands().size(); ++i) {
        if (table.bands()[i - 1].to < table.bands()[i].from) {
            return text + " Between bands that do not touch, the rule for low speed holds.";
        }
    }
    return text;
}

// "0.25", or "0.62 to 1.9" where bands or orders differ.
std::string q_text(const CandidateTable& table) {
    double least = table.bands().front().notches.front().notch.q, largest = least;
    for (const Band& band : table.bands()) {
        for (const CandidateNotch& notch : band.notches) {
            least = std::min(least, notch.notch.q);
            largest = std::max(largest, notch.notch.q);
        }
    }
    if (least == largest) return shortest(least);
    return fmt::format("{:.3g} to {:.3g}", least, largest);
}

// Which columns there are besides those that every table has.
struct Extra {
    std::size_t qs = 0;  // Q per order, one for all, or none because it stands in the heading
    bool held = false;   // where the orders count by their amplitudes, which the single lines do not say
    bool left = false;   // predicted residual
};

Extra extra_of(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    Extra extra{0, spec.amplitude_nm.size() > 1, !spec.amplitude_nm.empty()};
    const double q = table.bands().front().notches.front().notch.q;
    for (const Band& band : table.bands())
        for (const CandidateNotch& notch : band.notches)
            if (notch.notch.q != q) extra.qs = one_q_a_band(table) ? 1 : spec.orders.size();
    return extra;
}

std::vector<std::vector<std::string>> title_rows(const TableSpec& spec, const Extra& extra) {
    std::vector<std::string> titles = {"band", "speed"}, units = {"", "deg/s"};
    for (const Order order : spec.orders) {
        titles.push_back(order_in_words(order, spec.gear_ratio));
        units.push_back("Hz");
    }
    for (std::size_t i = 0; i < extra.qs; ++i) {
        titles.push_back(extra.qs == 1 ? "Q" : "Q " + order_text(spec.orders[i], spec.gear_ratio));
        units.push_back("");
    }
    titles.insert(titles.end(), {"DC delay", "settles", "overshoot"});
    units.insert(units.end(), {"ms", fmt::format("ms to {} %", plain(spec.settle_band_percent)), "%"});
    for (const Order order : spec.orders) {
        titles.push_back("worst " + order_text(order, spec.gear_ratio));
        units.push_back("dB");
    }
    if (extra.held) {
        titles.push_back("together");
        units.push_back("dB");
    }
    for (std::size_t i = 0; extra.left && i < spec.orders.size(); ++i) {
        titles.push_back("remaining " + order_text(spec.orders[i], spec.gear_ratio));
        units.push_back("Nm");
    }
    return {titles, units};
}

std::vector<std::string> band_row(const Band& band, const Extra& extra) {
    std::vector<std::string> row = {std::to_string(band.number),
                                    fmt::format("{:.5g}-{:.5g}", band.from.value(), band.to.value())};
    for (const CandidateNotch& notch : band.notches) {
        // A measured gear ratio makes 7.49999 of 7.5; the full digits are in the CSV and the JSON.
        row.push_back(fmt::format("{:.5g}", notch.notch.center.value()));
    }
    for (std::size_t i = 0; i < extra.qs; ++i) row.push_back(fmt::format("{:.3g}", band.notches[i].notch.q));
    row.push_back(fmt::format("{:.1f}", 1e3 * band.dc_delay.value()));
    row.push_back(fmt::format("{:.0f}", 1e3 * band.settle.value()));
    row.push_back(fmt::format("{:.1f}", band.overshoot_percent));
    for (const double worst : band.worst_attenuation_db) row.push_back(fmt::format("{:.1f}", worst));
    if (extra.held) row.push_back(fmt::format("{:.1f}", band.held_attenuation_db));
    for (const double left : band.predicted_residual_nm) row.push_back(fmt::format("{:.3f}", left));
    return row;
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

}  // namespace

std::string table_to_text(const CandidateTable& table, const DesignNote& note) {
    const TableSpec& spec = table.spec();
    const Extra extra = extra_of(table);
    std::string text = fmt::format(
        "Candidate notches for {}, at {} Hz: {} band{}, Q {} ({}), {}.\n\n", listed(spec),
        plain(spec.sample_rate.value()), table.bands().size(), table.bands().size() == 1 ? "" : "s",
        q_text(table), width_rule_name(spec.width),
        spec.depth_db >= infinite_depth_db ? "full null" : fmt::format("{} dB deep", plain(spec.depth_db)));
    auto rows = title_rows(spec, extra);
    for (const Band& band : table.bands()) rows.push_back(band_row(band, extra));
    text += text_table(rows, "r");
    text += "\nWorst: the least attenuation of that order's line anywhere in the band";
    if (spec.ratio_error >= 5e-5)
        text += fmt::format(", the gear ratio being up to {} % off", percent_text(100.0 * spec.ratio_error));
    if (spec.hysteresis.value() > 0.0)
        text +=
            fmt::format(", and {} deg/s beyond it, the switching hysteresis", plain(spec.hysteresis.value()));
    text += ". ";
    if (extra.held) text += "Together: attenuation of all orders, weighted by their amplitudes.  ";
    if (extra.left) text += "Remaining: largest amplitude of each order after the filter. ";
    text += delay_sentence(table.bands()) + "\n" + outside_sentence(table) + "\n";
    if (!note.reason.empty()) text += fmt::format("Chosen: {}.\n", note.reason);
    if (note.slowest) text += slowest_sentence(*note.max_delay, *note.slowest) + "\n";
    return text;
}

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

}  // namespace ripplenotch
