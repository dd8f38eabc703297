// SPDX-License-Identifier: MIT
#include "ripplenotch/core/spec.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

const Key* find_key(std::span<const Key> keys, std::string_view name) {
    const auto found =
        std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
    return found == keys.end() ? nullptr : &*found;
}

double checked_number(std::string_view text, const Key& key, std::string_view what) {
    const std::string label = fmt::format("{}, {}", what, key.name);
    const double value = parse_quantity(text, key.dimension, label);
    const auto limit = [&](double number) {
        const std::string_view unit = base_unit(key.dimension);
        return fmt::format("{}{}{}", shortest(number), unit.empty() ? "" : " ", unit);
    };
    if (!(value > key.above)) raise<UsageError>("{}: {} is not above {}", label, text, limit(key.above));
    if (!(value >= key.at_least)) raise<UsageError>("{}: {} is below {}", label, text, limit(key.at_least));
    if (!(value <= key.at_most))
        raise<UsageError>("{}: {} is above the limit of {}", label, text, limit(key.at_most));
    if (key.whole && value != std::floor(value))
        raise<UsageError>("{}: {} is not a whole number", label, text);
    return value;
}

// Insertions, deletions, replacements and exchanges of neighbours ("cvs"): the optimal string alignment
// distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before, above(b.size() + 1), row(b.size() + 1);
    std::iota(above.begin(), above.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), above[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before = std::exchange(above, row);
    }
    return above[b.size()];
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> pieces;
    while (true) {
        const std::size_t at = text.find(separator);
        pieces.push_back(text.substr(0, at));
        if (at == std::string_view::npos) return pieces;
        text.remove_prefix(at + 1);
    }
}

std::optional<std::string> nearest_name(std::string_view text, std::span<const std::string> known) {
    std::optional<std::string> best;
    std::size_t best_distance = std::max<std::size_t>(1, text.size() / 3) + 1;
    for (const std::string& name : known) {
        const auto [shorter, longer] = std::minmax({text.size(), name.size()});
        if (longer - shorter >= best_distance) continue;  // so is the distance
        const std::size_t distance = edit_distance(text, name);
        if (distance < best_distance) {
            best_distance = distance;
            best = name;
        }
    }
    return best;
}

namespace {

struct RemovedName {
    std::string_view name, instead;
};

constexpr RemovedName removed_names[] = {
#define REMOVED(name, instead) {name, instead},
#include "core/text/removed_names.def"
#undef REMOVED
};

}  // namespace

std::string did_you_mean(std::string_view text, std::span<const std::string> known) {
    for (const RemovedName& removed : removed_names)
        if (removed.name == text) return fmt::format(" any more; instead: {}", removed.instead);
    const auto near = nearest_name(text, known);
    return near ? fmt::format(" (did you mean {}?)", *near) : "";
}

void raise_no_entry(std::string_view kind, std::string_view plural, std::string_view name,
                    std::span<const std::string> known) {
    raise<UsageError>("there is no {} '{}'{}; {}: {}", kind, name, did_you_mean(name, known), plural,
                      fmt::join(known, ", "));
}

std::string Spec::text() const {
    std::string out = name;
    for (const auto& [key, value] : values) out += fmt::format(",{}={}", key, value);
    return out;
}

namespace {

// "centers=25Hz,50Hz": what stands between commas are keys, and a list has colons.
std::string list_hint(const Spec& spec, std::string_view piece) {
    if (spec.values.empty() || piece.empty() || std::isdigit(static_cast<unsigned char>(piece.front())) == 0)
        return "";
    const auto& [key, value] = spec.values.back();
    return fmt::format("; a list is written with colons: {}={}:{}", key, value, piece);
}

}  // namespace

namespace {

// At the commas outside of brackets: "tau[:,1],scale=1".
std::vector<std::string_view> pieces_of(std::string_view text) {
    std::vector<std::string_view> pieces;
    int depth = 0;
    for (const std::string_view piece : split(text, ',')) {
        if (depth > 0)
            pieces.back() = {pieces.back().data(), pieces.back().size() + 1 + piece.size()};
        else
            pieces.push_back(piece);
        for (const char c : piece) depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
    }
    return pieces;
}

}  // namespace

Spec parse_spec(std::string_view text) {
    Spec spec;
    const auto pieces = pieces_of(text);
    spec.name = std::string(pieces.front());
    if (spec.name.empty())
        raise<UsageError>("'{}': expected NAME,KEY=VALUE,..., but the name is empty", text);
    if (spec.name.find('=') != std::string::npos) {
        raise<UsageError>("'{}': expected NAME,KEY=VALUE,..., but it starts with '{}'", text, spec.name);
    }
    for (std::size_t i = 1; i < pieces.size(); ++i) {
        const std::size_t equals = pieces[i].find('=');
        if (equals == std::string_view::npos || equals == 0) {
            raise<UsageError>("'{}': '{}' is not KEY=VALUE{}", text, pieces[i], list_hint(spec, pieces[i]));
        }
        std::string key(pieces[i].substr(0, equals));
        for (const auto& [other, value] : spec.values) {
            if (other == key) raise<UsageError>("'{}': {} is given twice", text, key);
        }
        spec.values.emplace_back(std::move(key), std::string(pieces[i].substr(equals + 1)));
    }
    return spec;
}

Settings::Settings(std::string_view what, const Spec& spec, std::span<const Key> keys) : what_(what) {
    for (const Key& key : keys) {
        if (!key.default_text.empty()) texts_[std::string(key.name)] = std::string(key.default_text);
    }
    for (const auto& [name, value] : spec.values) {
        if (find_key(keys, name) == nullptr) {
            std::vector<std::string> known;
            for (const Key& key : keys) known.emplace_back(key.name);
            raise<UsageError>("{} has no key '{}'{}; its keys: {}", what, name, did_you_mean(name, known),
                              known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")));
        }
        texts_[name] = value;
    }
    for (const Key& key : keys) {
        const auto found = texts_.find(key.name);
        if (found == texts_.end()) {
            if (key.required) raise<UsageError>("{} needs {}=...: {}", what, key.name, key.help);
            continue;
        }
        const std::string& value = found->second;
        if (!key.choices.empty()) {
            const auto known = split(key.choices, ' ');
            if (std::find(known.begin(), known.end(), value) == known.end())
                raise<UsageError>("{}, {}: '{}' is none of {}", what, key.name, value,
                                  fmt::join(known, ", "));
        } else if (key.kind == KeyKind::text) {
            if (value.empty()) raise<UsageError>("{}, {}: the value is empty", what, key.name);
        } else {
            std::vector<std::string_view> pieces = {value};
            if (key.kind == KeyKind::list) pieces = split(value, ':');
            auto& numbers = numbers_[std::string(key.name)];
            for (const auto piece : pieces) numbers.push_back(checked_number(piece, key, what));
        }
    }
}

bool Settings::has(std::string_view key) const { return texts_.find(key) != texts_.end(); }

double Settings::number(std::string_view key) const { return list(key).front(); }

std::vector<double> Settings::list(std::string_view key) const {
    const auto found = numbers_.find(key);
    if (found == numbers_.end()) raise<UsageError>("{} needs {}=...", what_, key);
    return found->second;
}

std::string Settings::text(std::string_view key) const {
    const auto found = texts_.find(key);
    if (found == texts_.end()) raise<UsageError>("{} needs {}=...", what_, key);
    return found->second;
}

}  // namespace ripplenotch
