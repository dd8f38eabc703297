// SPDX-License-Identifier: MIT
#include "log/columns/drive_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <tuple>
#include <utility>

namespace ripplenotch {
namespace {

constexpr std::string_view counts = "counts", rate = "counts/s", share = "per mille";

constexpr std::array objects = {
    DriveObject{0x6062, Role::position, counts, true}, DriveObject{0x6063, Role::position, counts},
    DriveObject{0x6064, Role::position, counts},       DriveObject{0x6069, Role::velocity, rate},
    DriveObject{0x606B, Role::velocity, rate, true},   DriveObject{0x606C, Role::velocity, rate},
    DriveObject{0x6071, Role::torque, share, true},    DriveObject{0x6074, Role::torque, share, true},
    DriveObject{0x6077, Role::torque, share},          DriveObject{0x6078, Role::torque, share, false, true},
    DriveObject{0x607A, Role::position, counts, true}, DriveObject{0x60FF, Role::velocity, rate, true},
};
constexpr unsigned first_index = 0x6000, next_axis = 0x800, last_index = 0x9FFF;

struct ObjectName {
    std::string_view words;
    unsigned index;
};
// "Target velocity" is one of them, and everybody's name.
constexpr std::array object_names = {
    ObjectName{"position actual value", 0x6064}, ObjectName{"position actual internal value", 0x6063},
    ObjectName{"velocity actual value", 0x606C}, ObjectName{"velocity sensor actual value", 0x6069},
    ObjectName{"torque actual value", 0x6077},   ObjectName{"current actual value", 0x6078},
    ObjectName{"position demand value", 0x6062}, ObjectName{"velocity demand value", 0x606B},
};

const DriveObject* object_at(unsigned index) {
    const auto* const found = std::find_if(
        objects.begin(), objects.end(), [index](const DriveObject& object) { return object.index == index; });
    return found == objects.end() ? nullptr : found;
}

bool is_hex(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }
bool is_alnum(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

}  // namespace

NamedObject drive_object(std::string_view name) {
    for (std::size_t at = 0; at + 4 <= name.size(); ++at) {
        if (!std::all_of(name.begin() + static_cast<std::ptrdiff_t>(at),
                         name.begin() + static_cast<std::ptrdiff_t>(at) + 4, is_hex))
            continue;
        std::size_t begin = at, end = at + 4;
        const std::string_view before = name.substr(0, at);
        if (before.ends_with("0x") || before.ends_with("0X"))
            begin -= 2;
        else if (before.ends_with("16#"))
            begin -= 3;
        const bool marked = begin < at || (end < name.size() && (name[end] == 'h' || name[end] == 'H'));
        if (begin == at && marked) ++end;
        // A number of four digits that nothing marks is an index only where it is a word of its own.
        if ((begin > 0 && is_alnum(name[begin - 1])) || (end < name.size() && is_alnum(name[end]))) continue;
        unsigned index = 0;
        std::from_chars(name.data() + at, name.data() + at + 4, index, 16);
        if (index < first_index || index > last_index) continue;
        const DriveObject* const object = object_at(first_index + (index - first_index) % next_axis);
        if (object == nullptr) continue;
        // The sub-index: ":00", "_00", ".0".
        std::size_t sub = end;
        if (sub < name.size() && std::string_view(":_.").find(name[sub]) != std::string_view::npos) {
            const std::size_t zeros = name.find_first_not_of('0', sub + 1);
            const std::size_t after = zeros == std::string_view::npos ? name.size() : zeros;
            if (after > sub + 1 && (after == name.size() || !is_alnum(name[after]))) end = after;
        }
        const unsigned axis = (index - first_index) / next_axis;
        std::string rest(name.substr(0, begin));
        rest += axis > 0 ? fmt::format("_axis{}_", axis + 1) : "_";
        rest += name.substr(end);
        while (rest.ends_with('_')) rest.pop_back();
        return {object, rest};
    }
    return {nullptr, std::string(name)};
}

const DriveObject* drive_object_named(std::string_view words) {
    for (const ObjectName& known : object_names)
        if (words.find(known.words) != std::string_view::npos) return object_at(known.index);
    return nullptr;
}

std::optional<GermanWord> german_quantity(std::string_view word) {
    constexpr std::array quantities = {
        std::pair{std::string_view("position"), std::string_view("position")},
        std::pair{std::string_view("lage"), std::string_view("position")},
        std::pair{std::string_view("winkel"), std::string_view("position")},
        std::pair{std::string_view("geschwindigkeit"), std::string_view("velocity")},
        std::pair{std::string_view("drehzahl"), std::string_view("velocity")},
        std::pair{std::string_view("drehmoment"), std::string_view("torque")},
        std::pair{std::string_view("moment"), std::string_view("torque")},
        std::pair{std::string_view("strom"), std::string_view("current")}};
    for (const auto& [german, quantity] : quantities) {
        for (const auto& [front, back, reference] :
             {std::tuple("ist", "istwert", false), std::tuple("soll", "sollwert", true)}) {
            const bool before = word == fmt::format("{}{}", front, german);
            // Joined as they stand, or by an s or en: Lageistwert, Positionsistwert, Momentenistwert.
            const bool behind = word == fmt::format("{}{}", german, back) ||
                                word == fmt::format("{}s{}", german, back) ||
                                word == fmt::format("{}en{}", german, back);
            if (before || behind) return GermanWord{quantity, reference};
        }
    }
    return std::nullopt;
}

}  // namespace ripplenotch
