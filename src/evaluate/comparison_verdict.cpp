// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/evaluate/bench.hpp"
#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {
namespace {

bool is(const MethodFigures& figures, std::string_view method) {
    return figures.method == method || figures.method.rfind(std::string(method) + ",", 0) == 0;
}

std::vector<std::string> parts_of(const std::string& method) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= method.size();) {
        const std::size_t end = std::min(method.find(',', at), method.size());
        parts.push_back(method.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

constexpr std::size_t short_enough = 36;  // letters of a method that is told as it was typed
constexpr std::size_t longest_name = 40;  // of a name in a table and beside a line

// "oscillator B", with the letter that the page of results has for it.
std::string lettered(const std::string& method, const MethodFigures& figures, const Comparison& comparison) {
    std::size_t before = 0;
    for (const MethodFigures& other : comparison.methods) {
        if (&other == &figures) break;
        if (!is(other, "none")) ++before;
    }
    constexpr std::size_t letters = 'Z' - 'A' + 1;  // of the alphabet
    return before < letters ? fmt::format("{} {}", method, static_cast<char>('A' + before))
                            : fmt::format("{} M{}", method, before + 1);
}

}  // namespace

std::string short_name(const MethodFigures& figures, const Comparison& comparison) {
    if (figures.method.size() <= short_enough) return figures.method;
    const std::vector<std::string> parts = parts_of(figures.method);
    std::string name = parts.front();
    std::vector<std::vector<std::string>> others;
    for (const MethodFigures& other : comparison.methods) {
        if (&other != &figures && is(other, parts.front())) others.push_back(parts_of(other.method));
    }
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const bool shared = std::all_of(others.begin(), others.end(), [&](const auto& other) {
            return std::find(other.begin(), other.end(), parts[i]) != other.end();
        });
        if (!shared) name += "," + parts[i];
    }
    return name.size() <= longest_name ? name : lettered(parts.front(), figures, comparison);
}

namespace {

// "settles 2.8 times faster than B (147 against 408 ms to 0.5 %)"
std::string settling(const MethodFigures& a, const MethodFigures& b, const std::string& rival) {
    const double mine = (*a.settle_ms)[0], theirs = (*b.settle_ms)[0];
    const std::string figures =
        fmt::format("({:.0f} against {:.0f} ms to {} %)", mine, theirs, settle_bands_percent[0]);
    if (mine == theirs) return fmt::format("settles as fast as {} {}", rival, figures);
    if (mine == 0.0 || theirs == 0.0) {
        return fmt::format("settles {:.0f} ms {} than {} {}", std::abs(mine - theirs),
                           mine < theirs ? "earlier" : "later", rival, figures);
    }
    const double ratio = std::max(mine, theirs) / std::min(mine, theirs);
    if (ratio < 1.05) return fmt::format("settles about as fast as {} {}", rival, figures);
    return fmt::format("settles {:.1f} times {} than {} {}", ratio, mine < theirs ? "faster" : "slower",
                       rival, figures);
}

// "lags 38.9 ms less (38.0 against 76.9 ms)"; on a ramp where one was run, else by the DC group delay.
std::string lag(const MethodFigures& a, const MethodFigures& b, const std::string& rival) {
    const auto of = [](const MethodFigures& f) { return f.ramp_delay_ms ? f.ramp_delay_ms : f.dc_delay_ms; };
    if (!of(a) || !of(b)) return "";
    const double mine = *of(a), theirs = *of(b);
    const std::string than = rival.empty() ? "" : " than " + rival;
    const std::string figures = fmt::format("({} against {} ms)", rounded(mine, 1), rounded(theirs, 1));
    if (std::abs(mine - theirs) < 0.05) return fmt::format("lags as much {}", figures);
    return fmt::format("lags {:.1f} ms {}{} {}", std::abs(mine - theirs), mine < theirs ? "less" : "more",
                       than, figures);
}

std::string decibels(double db) {
    return db >= most_attenuation_db ? fmt::format("more than {:.0f} dB", most_attenuation_db)
                                     : fmt::format("{} dB", rounded(db, 1));
}

// The least attenuation of any line.
std::optional<double> least_db(const MethodFigures& figures) {
    std::optional<double> least;
    for (const OrderAttenuation& entry : figures.attenuation) {
        if (entry.db) least = std::min(least.value_or(*entry.db), *entry.db);
    }
    return least;
}

std::string ripple(const MethodFigures& a, const MethodFigures& b, const Comparison& comparison) {
    if (comparison.match && comparison.match->low_pass == b.method) return comparison.match->clause;
    if (a.ripple_rms_nm && b.ripple_rms_nm) {
        return fmt::format("and leaves {:.3g} Nm rms of ripple against {:.3g}", *a.ripple_rms_nm,
                           *b.ripple_rms_nm);
    }
    const auto mine = least_db(a), theirs = least_db(b);
    if (!mine || !theirs) return "";
    return fmt::format("and takes {} off its weakest line against {}", decibels(*mine), decibels(*theirs));
}

std::string alone(const MethodFigures& a, const std::string& name) {
    std::vector<std::string> parts;
    if (a.settle_ms)
        parts.push_back(
            fmt::format("settles in {:.0f} ms to {} %", (*a.settle_ms)[0], settle_bands_percent[0]));
    if (const auto delay = a.ramp_delay_ms ? a.ramp_delay_ms : a.dc_delay_ms)
        parts.push_back(fmt::format("lags {} ms", rounded(*delay, 1)));
    if (a.ripple_rms_nm) {
        parts.push_back(fmt::format("leaves {:.3g} Nm rms of ripple", *a.ripple_rms_nm));
    } else if (const auto db = least_db(a)) {
        parts.push_back(fmt::format("takes {} off its weakest line", decibels(*db)));
    }
    if (parts.empty()) return fmt::format("{}: nothing was asked for that could be measured.", name);
    return fmt::format("{} {}.", name, fmt::join(parts, ", "));
}

// " Nearest to the truth is oscillator: 0.0281 Nm rms off, switching 0.783."; nothing where one ran, or no
// truth is known.
std::string nearest(const MethodFigures& a, const std::string& name, const Comparison& comparison) {
    const MethodFigures* best = nullptr;
    std::size_t known = 0;
    for (const MethodFigures& figures : comparison.methods) {
        if (!figures.error_rms_nm) continue;
        if (part_of(figures) != MethodPart::control) ++known;
        if (best == nullptr || *figures.error_rms_nm < *best->error_rms_nm) best = &figures;
    }
    if (known < 2 || !a.error_rms_nm) return "";
    if (best == &a)
        return fmt::format(" Nearest to the truth is {}: {:.3g} Nm rms off.", name, *a.error_rms_nm);
    return fmt::format(" Nearest to the truth is {}: {:.3g} Nm rms off, {} {:.3g}.",
                       short_name(*best, comparison), *best->error_rms_nm, name, *a.error_rms_nm);
}

}  // namespace

MethodPart part_of(const MethodFigures& figures) {
    for (const Method* method : methods()) {
        if (is(figures, method->name)) return method->part;
    }
    return MethodPart::contender;
}

const MethodFigures* Comparison::subject() const {
    const MethodFigures* found = nullptr;
    for (const MethodFigures& figures : methods) {
        const MethodPart part = part_of(figures);
        if (part == MethodPart::control) continue;
        if (part == MethodPart::contender) return &figures;
        if (found == nullptr) found = &figures;
    }
    return found;
}

const MethodFigures* Comparison::rival() const {
    const MethodFigures *rival = nullptr, *other = nullptr;
    for (const MethodFigures& figures : methods) {
        const MethodPart part = part_of(figures);
        if (&figures == subject() || part == MethodPart::control) continue;
        if (match && match->low_pass == figures.method) return &figures;
        if (rival == nullptr && part == MethodPart::rival) rival = &figures;
        if (other == nullptr) other = &figures;
    }
    return rival != nullptr ? rival : other;
}

std::string verdict(const Comparison& comparison) {
    const MethodFigures* const a = comparison.subject();
    if (a == nullptr) return "Only the control ran; there is nothing to compare.";
    const MethodFigures* const b = comparison.rival();
    const std::string name = short_name(*a, comparison);
    if (b == nullptr) return alone(*a, name);
    const std::string rival = short_name(*b, comparison);
    std::vector<std::string> parts;
    if (a->settle_ms && b->settle_ms) parts.push_back(settling(*a, *b, rival));
    if (const std::string text = lag(*a, *b, parts.empty() ? rival : ""); !text.empty())
        parts.push_back(text);
    if (const std::string text = ripple(*a, *b, comparison); !text.empty()) parts.push_back(text);
    return fmt::format("{} {}.{}", name, fmt::join(parts, ", "), nearest(*a, name, comparison));
}

}  // namespace ripplenotch
