// SPDX-License-Identifier: MIT
// --joint: which joints of a log are meant by names, numbers, lists and ranges.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

using Joints = std::vector<std::string>;

/// What stands before the number at the end of a name, "panda_joint" of "panda_joint3".
std::string_view letters_of(std::string_view name) {
    return name.substr(0, name.find_last_not_of("0123456789") + 1);
}

/// By its name, else by "3", "j3" or "joint3" for each other, else by the number that its name ends in.
std::optional<std::size_t> place_of(const Joints& joints, const std::string& word) {
    const auto place = [&](Joints::const_iterator at) {
        const auto number = static_cast<std::size_t>(at - joints.begin());
        return at == joints.end() ? std::nullopt : std::optional(number);
    };
    if (const auto named = place(std::ranges::find(joints, word)); named || word.empty()) return named;
    if (const auto alike = place(std::ranges::find(joints, joint_key(word), joint_key))) return alike;
    const auto ends_in_it = [&](const std::string& joint) {
        return letters_of(joint).size() + word.size() == joint.size() && joint.ends_with(word);
    };
    if (!is_digits(word) || std::ranges::count_if(joints, ends_in_it) != 1) return std::nullopt;
    return place(std::ranges::find_if(joints, ends_in_it));
}

/// Both ends of "j1-j3". A name that holds a hyphen may be one, so that each hyphen is tried.
std::optional<std::pair<std::size_t, std::size_t>> range_of(const Joints& joints, const std::string& entry) {
    for (std::size_t dash = entry.find('-'); dash != std::string::npos; dash = entry.find('-', dash + 1)) {
        const auto first = place_of(joints, entry.substr(0, dash)),
                   last = place_of(joints, entry.substr(dash + 1));
        if (first && last) return std::pair(*first, *last);
    }
    return std::nullopt;
}

[[noreturn]] void refuse(const std::string& source, const std::string& asked, const std::string& entry,
                         const Joints& joints) {
    if (joints.size() == 1 && joints[0].empty())
        raise<UsageError>("--joint {}: {} holds one joint without a name; leave --joint out", asked, source);
    if (joints.empty()) raise<UsageError>("--joint {}: {} has none with velocity and torque", asked, source);
    raise<UsageError>(
        "--joint {}: {} has no joint '{}'; it has {} (names, numbers and ranges: --joint {})", asked, source,
        entry, fmt::join(joints, ", "),
        joints.size() < 3 ? joints.front() : fmt::format("{},{}-{}", joints[0], joints[1], joints.back()));
}

}  // namespace

std::vector<std::string> select_joints(const std::string& source, const std::string& asked,
                                       const std::vector<std::string>& joints) {
    std::vector<bool> taken(joints.size());
    // Numbered joints are counted by their numbers, whatever the order of their columns; others by the order
    // of the log.
    const auto take_between = [&](const std::string& entry, std::size_t first, std::size_t last) {
        const std::string_view letters = letters_of(joints[first]);
        const auto number = [&](std::size_t j) {
            return parse_number(std::string_view(joints[j]).substr(letters.size()));
        };
        const bool numbered = letters == letters_of(joints[last]) && number(first) && number(last);
        if (numbered ? *number(first) > *number(last) : first > last)
            raise<UsageError>("--joint {}: '{}' runs backwards; {} has {}", asked, entry, source,
                              fmt::join(joints, ", "));
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const bool between = numbered ? letters_of(joints[j]) == letters && number(j) &&
                                                *number(j) >= *number(first) && *number(j) <= *number(last)
                                          : j >= first && j <= last;
            if (between) taken[j] = true;
        }
    };
    const auto take = [&](const std::string& entry) {
        if (entry == "all")
            taken.assign(joints.size(), true);
        else if (const auto one = place_of(joints, entry))
            taken[*one] = true;
        else if (const auto range = range_of(joints, entry))
            take_between(entry, range->first, range->second);
        else
            refuse(source, asked, entry, joints);
    };
    // A name may hold a comma or a hyphen itself.
    if (place_of(joints, asked))
        take(asked);
    else
        for (const std::string_view entry : split(asked, ',')) take(std::string(entry));
    std::vector<std::string> selected;
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (taken[j]) selected.push_back(joints[j]);
    return selected;
}

}  // namespace ripplenotch
