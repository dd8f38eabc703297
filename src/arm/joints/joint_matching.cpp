// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "core/text/lower_case.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace {

// A position this many times beyond the limits in this part of the rows is in another unit.
constexpr double times_beyond = 3.0, part_of_rows = 0.1;
constexpr double few_told = 0.5;  // share of the identifiable values

void check_unit(const ChainJoint& joint, const TraceView& log, const std::string& name) {
    if (!joint.limits || joint.kind == JointKind::prismatic) return;
    const double most =
        times_beyond * std::max(std::abs(joint.limits->first), std::abs(joint.limits->second));
    const auto beyond = std::count_if(log.position_deg.begin(), log.position_deg.end(),
                                      [&](double position) { return std::abs(position) > most; });
    if (static_cast<double>(beyond) <= part_of_rows * static_cast<double>(log.size())) return;
    double farthest = 0.0;
    for (const double position : log.position_deg) farthest = std::max(farthest, std::abs(position));
    raise<DataError>(
        "arm: position of '{}' reaches {:.3g} rad ({:.4g} deg), and joint '{}' goes to {:.4g} deg; is it in "
        "deg? --unit position=deg",
        name, farthest * std::numbers::pi / 180.0, farthest, joint.name,
        std::max(std::abs(joint.limits->first), std::abs(joint.limits->second)));
}

}  // namespace

std::vector<JointTravel> arm_travel(const Chain& chain, const ArmLog& log,
                                    const std::vector<std::string>& log_joints) {
    std::vector<JointTravel> travel;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const auto& position = log.joints[j].position_deg;
        check_unit(chain.joints[j], log.joints[j], log_joints[j]);
        const auto [low, high] = std::minmax_element(position.begin(), position.end());
        travel.push_back({chain.joints[j].name, log_joints[j], position.empty() ? 0.0 : *high - *low});
    }
    return travel;
}

std::vector<std::string> arm_warnings(const ArmFit& fit, const std::vector<JointTravel>& travel) {
    std::vector<std::string> still, warnings;
    for (const JointTravel& joint : travel)
        if (joint.travel_deg < min_travel_deg) still.push_back(fmt::format("'{}'", joint.log));
    const std::string names = fmt::format("{}", fmt::join(still, ", "));
    if (static_cast<double>(fit.values_told) < few_told * static_cast<double>(fit.values_there)) {
        warnings.push_back(fmt::format(
            "arm: {} of {} values can be determined from this log{}; a motion of all joints determines more",
            fit.values_told, fit.values_there,
            still.empty() ? ""
                          : fmt::format(", in which {} hardly move{}", names, still.size() == 1 ? "s" : "")));
    } else if (!still.empty()) {
        warnings.push_back(fmt::format(
            "arm: {} move{} less than {:g} deg; the inertia of {} cannot be identified separately", names,
            still.size() == 1 ? "s" : "", min_travel_deg, still.size() == 1 ? "its link" : "their links"));
    }
    return warnings;
}

namespace {

constexpr std::array<std::string_view, 4> empty_words = {"joint", "axis", "link", "robot"};

// "Panda_Joint-1" is "panda1".
std::string bare_name(std::string_view name) {
    std::string bare = lower_case(name);
    std::erase_if(bare, [](char letter) { return letter == '_' || letter == '-' || letter == ' '; });
    for (const std::string_view word : empty_words) {
        for (std::size_t at = bare.find(word); at != std::string::npos; at = bare.find(word))
            bare.erase(at, word.size());
    }
    return bare;
}

std::optional<int> last_number(std::string_view name) {
    std::size_t first = name.size();
    while (first > 0 && std::isdigit(static_cast<unsigned char>(name[first - 1])) != 0) --first;
    const std::string_view digits = name.substr(first);
    if (digits.empty() || digits.size() > 6) return std::nullopt;
    int number = 0;
    for (const char digit : digits) number = 10 * number + (digit - '0');
    return number;
}

class Matcher {
  public:
    Matcher(const Chain& chain, std::span<const std::string> log, std::string_view log_name)
        : chain_(chain), log_(log), log_name_(log_name), found_(chain.size()) {}

    JointMatch run(const StatedJoints& stated) {
        for (const auto& [joint, partner] : stated) match_stated(joint, partner);
        std::string rule = "as stated";
        if (left().empty())
            ;
        else if (by_name())
            rule = "by name";
        else if (by_number())
            rule = "by number";
        else if (by_order())
            rule = "by order";
        else
            refuse();
        return told(rule);
    }

  private:
    using Pairs = std::map<std::size_t, std::size_t>;

    [[nodiscard]] std::vector<std::size_t> left() const {
        std::vector<std::size_t> joints;
        for (std::size_t j = 0; j < found_.size(); ++j)
            if (!found_[j]) joints.push_back(j);
        return joints;
    }

    [[nodiscard]] bool is_taken(std::size_t partner) const {
        return std::find(found_.begin(), found_.end(), std::optional(partner)) != found_.end();
    }

    void match_stated(const std::string& joint, const std::string& partner) {
        const auto place = chain_.find(joint);
        if (!place)
            raise<UsageError>("arm: joints={}:{}: '{}' is no joint of {}; {}", joint, partner, joint,
                              chain_.source, joint_list(chain_));
        const auto found = std::find(log_.begin(), log_.end(), partner);
        if (found == log_.end()) {
            const std::vector<std::string> names(log_.begin(), log_.end());
            raise<UsageError>("arm: joints={}:{}: {} has no joint '{}'{}; it has {}", joint, partner,
                              log_name_, partner, did_you_mean(partner, names), fmt::join(names, ", "));
        }
        const auto partner_place = static_cast<std::size_t>(found - log_.begin());
        if (found_[*place] || is_taken(partner_place))
            raise<UsageError>("arm: joints={}:{}: one of the two has a partner already", joint, partner);
        found_[*place] = partner_place;
    }

    // All that are left or none, and no two the same.
    bool accept(const Pairs& pairs) {
        std::set<std::size_t> partners;
        for (const auto& [joint, partner] : pairs) partners.insert(partner);
        if (pairs.size() != left().size() || partners.size() != pairs.size()) return false;
        for (const auto& [joint, partner] : pairs) found_[joint] = partner;
        return true;
    }

    template <class Key>
    Pairs pairs_by(const Key& same) const {
        Pairs pairs;
        for (const std::size_t joint : left()) {
            std::size_t fitting = 0;
            for (std::size_t partner = 0; partner < log_.size(); ++partner) {
                if (is_taken(partner) || !same(joint, partner)) continue;
                pairs[joint] = partner;
                ++fitting;
            }
            if (fitting != 1) return {};
        }
        return pairs;
    }

    bool by_name() {
        return accept(pairs_by([&](std::size_t joint, std::size_t partner) {
            const std::string bare = bare_name(chain_.joints[joint].name);
            return !bare.empty() && bare == bare_name(log_[partner]);
        }));
    }

    bool by_number() {
        for (const int shift : {0, 1, -1}) {
            const bool matched = accept(pairs_by([&](std::size_t joint, std::size_t partner) {
                const auto mine = last_number(chain_.joints[joint].name), theirs = last_number(log_[partner]);
                return mine && theirs && *mine == *theirs + shift;
            }));
            if (matched) return true;
        }
        return false;
    }

    bool by_order() {
        if (log_.size() != chain_.size() || left().size() != chain_.size()) return false;
        Pairs pairs;
        for (std::size_t j = 0; j < chain_.size(); ++j) pairs[j] = j;
        return accept(pairs);
    }

    [[noreturn]] void refuse() const {
        const Pairs names = partial([&](std::size_t joint, std::size_t partner) {
            return bare_name(chain_.joints[joint].name) == bare_name(log_[partner]);
        });
        const Pairs numbers = partial([&](std::size_t joint, std::size_t partner) {
            const auto mine = last_number(chain_.joints[joint].name), theirs = last_number(log_[partner]);
            return mine && theirs && *mine == *theirs;
        });
        const Pairs& best = names.size() >= numbers.size() ? names : numbers;
        std::string lonely = chain_.joints[left().front()].name;
        for (const std::size_t joint : left()) {
            if (best.count(joint) != 0) continue;
            lonely = chain_.joints[joint].name;
            break;
        }
        raise<UsageError>(
            "arm: {} has the joint '{}', and {} holds no position of it (its joints: {}); name it with "
            "joints={}:NAME, or keep it still in the model with joints={}:=0deg",
            chain_.source, lonely, log_name_, fmt::join(log_, ", "), lonely, lonely);
    }

    template <class Key>
    Pairs partial(const Key& same) const {
        Pairs pairs;
        for (const std::size_t joint : left())
            for (std::size_t partner = 0; partner < log_.size(); ++partner)
                if (!is_taken(partner) && same(joint, partner)) pairs[joint] = partner;
        return pairs;
    }

    JointMatch told(const std::string& rule) const {
        JointMatch match{{}, rule, "joints=", {}, {}};
        std::vector<std::string> pairs;
        for (std::size_t j = 0; j < chain_.size(); ++j) {
            match.of.push_back(*found_[j]);
            pairs.push_back(fmt::format("{}:{}", chain_.joints[j].name, log_[*found_[j]]));
        }
        match.option += fmt::format("{}", fmt::join(pairs, "|"));
        if (rule == "by order") {
            match.warnings.push_back(
                fmt::format("arm: joints of {} and of {} have nothing in common but their number and are "
                            "paired in order: {}",
                            chain_.source, log_name_, fmt::join(pairs, ", ")));
        }
        for (std::size_t partner = 0; partner < log_.size(); ++partner) {
            if (is_taken(partner)) continue;
            match.notes.push_back(
                fmt::format("arm: '{}' of the log is not part of the chain; its motion is not in the model",
                            log_[partner]));
        }
        return match;
    }

    const Chain& chain_;
    std::span<const std::string> log_;
    std::string_view log_name_;
    std::vector<std::optional<std::size_t>> found_;
};

}  // namespace

JointMatch match_joints(const Chain& chain, std::span<const std::string> log_joints,
                        const StatedJoints& stated, std::string_view log_name) {
    return Matcher(chain, log_joints, log_name).run(stated);
}

}  // namespace ripplenotch
