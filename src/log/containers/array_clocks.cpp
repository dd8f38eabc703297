// SPDX-License-Identifier: MIT
#include "log/containers/array_clocks.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "log/columns/column_name.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t compared_at_once = std::size_t{1} << 15;  // rows

bool names_time(const StoredArray& array) {
    if (!array.shape.vector) return false;
    const ColumnName name =
        read_column_name(array.read_as.empty() ? last_word(without_empty_words(array.path)) : array.read_as);
    return name.role == Role::time && !name.reference;
}

bool same_numbers(const StoredArray& one, const StoredArray& other) {
    if (one.type.kind != other.type.kind || one.type.size != other.type.size ||
        one.type.big_endian != other.type.big_endian)
        return false;
    const auto left = one.open(0), right = other.open(0);
    std::string a, b;
    for (std::size_t done = 0; done < one.shape.rows;) {
        const std::size_t rows = std::min(compared_at_once, one.shape.rows - done);
        a.resize(rows * one.type.size);
        b.resize(a.size());
        left->read(rows, a.data());
        right->read(rows, b.data());
        if (a != b) return false;
        done += rows;
    }
    return true;
}

class FoundClocks {
  public:
    explicit FoundClocks(const std::vector<StoredArray>& arrays) : arrays_(arrays), clock_(arrays.size()) {
        for (std::size_t a = 0; a < arrays.size(); ++a) {
            if (arrays[a].shape.rows < 2 || !names_time(arrays[a])) continue;
            times_.emplace(Scope{path_around(without_empty_words(arrays[a].path)), arrays[a].shape.rows}, a);
        }
        for (std::size_t a = 0; a < arrays.size(); ++a) clock_[a] = nearest(a);
        for (std::optional<std::size_t>& clock : clock_)
            if (clock) clock = first_of_equals(*clock);
        share();
    }
    [[nodiscard]] std::vector<ArrayGroup> groups() const {
        std::map<std::pair<std::size_t, std::size_t>, ArrayGroup> groups;
        for (std::size_t a = 0; a < arrays_.size(); ++a) {
            if (arrays_[a].shape.rows < 2) continue;
            const std::size_t clock = clock_[a].value_or(arrays_.size());
            ArrayGroup& group = groups[{arrays_[a].shape.rows, clock}];
            group.rows = arrays_[a].shape.rows;
            if (clock_[a]) group.clock = &arrays_[clock];
            if (!is_copy(a)) group.arrays.push_back(&arrays_[a]);
        }
        std::vector<ArrayGroup> found;
        for (auto& [key, group] : groups) found.push_back(std::move(group));
        return found;
    }

  private:
    using Scope = std::pair<std::string, std::size_t>;  // a folder, and rows

    [[nodiscard]] std::optional<std::size_t> nearest(std::size_t a) const {
        const std::size_t rows = arrays_[a].shape.rows;
        std::string folder = path_around(arrays_[a].path);
        while (true) {
            if (const auto found = times_.find({folder, rows}); found != times_.end()) return found->second;
            if (folder.empty()) return std::nullopt;
            folder = path_around(folder);
        }
    }
    std::size_t first_of_equals(std::size_t clock) {
        const auto known = equal_to_.find(clock);
        if (known != equal_to_.end()) return known->second;
        std::size_t first = clock;
        for (const std::size_t other : distinct_) {
            if (arrays_[other].shape.rows != arrays_[clock].shape.rows) continue;
            if (!same_numbers(arrays_[other], arrays_[clock])) continue;
            first = other;
            break;
        }
        if (first == clock) distinct_.push_back(clock);
        return equal_to_[clock] = first;
    }
    // An array that nothing is said of has the only clock of its length.
    void share() {
        for (std::size_t a = 0; a < arrays_.size(); ++a) {
            if (clock_[a]) continue;
            std::vector<std::size_t> fitting;
            for (const std::size_t clock : distinct_)
                if (arrays_[clock].shape.rows == arrays_[a].shape.rows) fitting.push_back(clock);
            if (fitting.size() == 1) clock_[a] = fitting.front();
        }
    }
    // Of a clock that stands in another folder.
    [[nodiscard]] bool is_copy(std::size_t a) const {
        const auto known = equal_to_.find(a);
        return known != equal_to_.end() && known->second != a;
    }

    const std::vector<StoredArray>& arrays_;
    std::map<Scope, std::size_t> times_;             ///< the first in each
    std::vector<std::optional<std::size_t>> clock_;  ///< of each array
    std::vector<std::size_t> distinct_;
    std::map<std::size_t, std::size_t> equal_to_;
};

}  // namespace

std::string last_word(const std::string& path) {
    const std::size_t end = path.find_last_of("./");
    return end == std::string::npos ? path : path.substr(end + 1);
}

std::string path_around(const std::string& path) {
    const std::size_t end = path.find_last_of("./");
    return end == std::string::npos ? std::string() : path.substr(0, end);
}

std::string without_empty_words(const std::string& path) {
    constexpr std::array empty_words = {"value", "Value", "data", "Data", "values", "Values", "signals"};
    std::string rest = path;
    while (std::find(empty_words.begin(), empty_words.end(), last_word(rest)) != empty_words.end() &&
           path_around(rest).size() > 0)
        rest = path_around(rest);
    return rest;
}

std::vector<ArrayGroup> groups_by_clock(const std::vector<StoredArray>& arrays) {
    return FoundClocks(arrays).groups();
}

}  // namespace ripplenotch
