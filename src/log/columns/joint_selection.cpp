// SPDX-License-Identifier: MIT
// --joint: which joints of a log are meant by names, numbers, lists and ranges.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "log/columns/column_name.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

std::vector<std::string> split_commas(std::string_view text) {
    std::vector<std::string> entries;
    for (std::size_t comma = 0; comma != std::string_view::npos; text.remove_prefix(comma + 1)) {
        comma = text.find(',');
        entries.emplace_back(text.substr(0, comma));
        if (comma == std::string_view::npos) break;
    }
    return entries;
}

bool is_ascii_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// What stands before the number at the end of a name, "panda_joint" of "panda_joint3".
std::string_view letters_of(std::string_view name) {
    return name.substr(0, name.find_last_not_of("0123456789") + 1);
}

class Selection {
  public:
    Selection(const std::string& source, const std::string& asked, const std::vector<std::string>& joints)
        : source_(source), asked_(asked), joints_(joints), taken_(joints.size()) {}

    std::vector<std::string> run() {
        // A name may hold a comma or a hyphen itself.
        if (const auto one = place_of(asked_))
            taken_[*one] = true;
        else
            for (const std::string& entry : split_commas(asked_)) take(entry);
        std::vector<std::string> selected;
        for (std::size_t j = 0; j < joints_.size(); ++j)
            if (taken_[j]) selected.push_back(joints_[j]);
        return selected;
    }

  private:
    void take(const std::string& entry) {
        if (entry == "all") {
            taken_.assign(joints_.size(), true);
        } else if (const auto one = place_of(entry)) {
            taken_[*one] = true;
        } else if (!take_range(entry)) {
            refuse(entry);
        }
    }

    // A name that holds a hyphen may be an end of a range, so that each hyphen is tried.
    bool take_range(const std::string& entry) {
        for (std::size_t dash = entry.find('-'); dash != std::string::npos;
             dash = entry.find('-', dash + 1)) {
            const auto first = place_of(entry.substr(0, dash)), last = place_of(entry.substr(dash + 1));
            if (!first || !last) continue;
            take_between(entry, *first, *last);
            return true;
        }
        return false;
    }

    // Numbered joints are counted by their numbers, whatever the order of their columns; others by the order
    // of the log.
    void take_between(const std::string& entry, std::size_t first, std::size_t last) {
        const std::string_view letters = letters_of(joints_[first]);
        const auto number = [&](std::size_t j) {
            return parse_number(std::string_view(joints_[j]).substr(letters.size()));
        };
        const bool numbered = letters == letters_of(joints_[last]) && number(first) && number(last);
        if (numbered ? *number(first) > *number(last) : first > last)
            raise<UsageError>("--joint {}: '{}' runs backwards; {} has {}", asked_, entry, source_,
                              fmt::join(joints_, ", "));
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            const bool between = numbered ? letters_of(joints_[j]) == letters && number(j) &&
                                                *number(j) >= *number(first) && *number(j) <= *number(last)
                                          : j >= first && j <= last;
            if (between) taken_[j] = true;
        }
    }

    /// By its name, else by "3", "j3" or "joint3" for each other, else by the number that its name ends in.
    std::optional<std::size_t> place_of(const std::string& word) const {
        const auto find = [&](const auto& is_meant) -> std::optional<std::size_t> {
            const auto at = std::ranges::find_if(joints_, is_meant);
            if (at == joints_.end()) return std::nullopt;
            return static_cast<std::size_t>(at - joints_.begin());
        };
        if (const auto named = find([&](const std::string& joint) { return joint == word; })) return named;
        if (word.empty()) return std::nullopt;
        const std::string key = joint_key(word);
        if (const auto alike = find([&](const std::string& joint) { return joint_key(joint) == key; }))
            return alike;
        if (!std::ranges::all_of(word, is_ascii_digit)) return std::nullopt;
        const auto ends_in_it = [&](const std::string& joint) {
            return letters_of(joint).size() + word.size() == joint.size() && joint.ends_with(word);
        };
        if (std::ranges::count_if(joints_, ends_in_it) != 1) return std::nullopt;
        return find(ends_in_it);
    }

    [[noreturn]] void refuse(const std::string& entry) const {
        if (joints_.size() == 1 && joints_[0].empty())
            raise<UsageError>("--joint {}: {} holds one joint without a name; leave --joint out", asked_,
                              source_);
        if (joints_.empty())
            raise<UsageError>("--joint {}: {} has none with velocity and torque", asked_, source_);
        raise<UsageError>(
            "--joint {}: {} has no joint '{}'; it has {} (names, numbers and ranges: --joint {})", asked_,
            source_, entry, fmt::join(joints_, ", "),
            joints_.size() < 3 ? joints_.front()
                               : fmt::format("{},{}-{}", joints_[0], joints_[1], joints_.back()));
    }

    const std::string& source_;
    const std::string& asked_;
    const std::vector<std::string>& joints_;
    std::vector<bool> taken_;
};

}  // namespace

std::vector<std::string> select_joints(const std::string& source, const std::string& asked,
                                       const std::vector<std::string>& joints) {
    if (asked == "all") return joints;
    return Selection(source, asked, joints).run();
}

}  // namespace ripplenotch
