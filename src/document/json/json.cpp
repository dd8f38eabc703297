// SPDX-License-Identifier: MIT
#include "document/json/json.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <unordered_set>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

bool is_time(std::string_view name) { return name.ends_with("_s") && !name.ends_with("deg_s"); }

void round_fitted(Json& json) {
    if (json.is_number_float()) {
        json = to_digits(json.get<double>());
    } else if (json.is_object()) {
        for (auto& [name, value] : json.items()) {
            if (!is_time(name)) round_fitted(value);
        }
    } else if (json.is_array()) {
        for (Json& value : json) round_fitted(value);
    }
}

}  // namespace

Json six_digits(double value) { return finite_or_null(to_digits(value, 6) + 0.0); }

std::string to_fitted_text(Json json) {
    round_fitted(json);
    return to_text(json);
}

std::string to_text(const Json& json) {
    // Names of files and columns may hold bytes that are not UTF-8; they are replaced rather than refused.
    return visible_json(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

namespace {

constexpr double largest_json_number = 1e100;  ///< either side of 0

// The parser says where it is only when the text is no JSON; this says it always.
class Watched {
  public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    Watched(const char* at, const char** seen) : at_(at), seen_(seen) {}
    reference operator*() const { return *at_; }
    Watched& operator++() {
        *seen_ = ++at_;
        return *this;
    }
    Watched operator++(int) {
        Watched before = *this;
        ++*this;
        return before;
    }
    bool operator==(const Watched& other) const { return at_ == other.at_; }
    bool operator!=(const Watched& other) const { return at_ != other.at_; }

  private:
    const char* at_;
    const char** seen_;
};

// Builds the document as the parser reads it, and ends it at the first thing that no document may hold.
class Builder : public nlohmann::json_sax<Json> {
  public:
    bool null() override { return add(nullptr) != nullptr; }
    bool boolean(bool value) override { return add(value) != nullptr; }
    bool number_integer(number_integer_t value) override { return add(value) != nullptr; }
    bool number_unsigned(number_unsigned_t value) override { return add(value) != nullptr; }
    bool number_float(number_float_t value, const string_t& digits) override {
        if (std::abs(value) <= largest_json_number) return add(value) != nullptr;
        number = digits;
        return false;
    }
    bool string(string_t& value) override { return add(std::move(value)) != nullptr; }
    bool binary(binary_t& /*value*/) override { return false; }  // JSON text has none
    bool start_object(std::size_t /*size*/) override { return open(Json::object()); }
    bool start_array(std::size_t /*size*/) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        Level& level = levels_.back();
        const auto& members = level.value->get_ref<const Json::object_t&>();
        if (members.size() == max_json_members)
            return refuse(fmt::format("an object of more than {} members", max_json_members));
        if (!is_new(level, members, name))
            return refuse(fmt::format("the name \"{}\" for a second time", name));
        level.name = std::move(name);
        return true;
    }

    bool parse_error(std::size_t /*at*/, const std::string& token,
                     const nlohmann::detail::exception& error) override {
        constexpr int no_double = 406;
        if (error.id == no_double) number = token;
        return false;
    }

    Json document;
    std::string refused;  // what it was; empty where the text is no JSON
    std::string number;   // that is too large

  private:
    struct Level {
        Json* value;
        std::string name = {};                       // of the member that comes next
        std::unordered_set<std::string> names = {};  // of all members, where they are many
    };

    bool refuse(std::string what) {
        refused = std::move(what);
        return false;
    }

    static bool is_new(Level& level, const Json::object_t& members, const std::string& name) {
        constexpr std::size_t few = 16;
        if (members.size() < few)
            return std::none_of(members.begin(), members.end(),
                                [&](const auto& member) { return member.first == name; });
        if (level.names.empty())
            for (const auto& member : members) level.names.insert(member.first);
        return level.names.insert(name).second;
    }

    Json* add(Json value) {
        if (++values_ > max_json_values) {
            refuse(fmt::format("more than {} values", max_json_values));
            return nullptr;
        }
        if (levels_.empty()) return &(document = std::move(value));
        Level& level = levels_.back();
        if (level.value->is_array())
            return &level.value->get_ref<Json::array_t&>().emplace_back(std::move(value));
        // Past the object's own way in, which looks through all its members.
        auto& members = level.value->get_ref<Json::object_t&>();
        return &members.Json::object_t::Container::emplace_back(std::move(level.name), std::move(value))
                    .second;
    }

    bool open(Json value) {
        if (levels_.size() == max_json_depth)
            return refuse(fmt::format("lists and objects more than {} deep", max_json_depth));
        Json* const added = add(std::move(value));
        if (added != nullptr) levels_.push_back({added});
        return added != nullptr;
    }

    bool close() {
        levels_.pop_back();
        return true;
    }

    std::vector<Level> levels_;
    std::size_t values_ = 0;
};

// "table.json:3:17", of the last character before `at`.
std::string place_in_text(std::string_view text, std::size_t at, const std::string& source) {
    const std::string_view before = text.substr(0, at == 0 ? 0 : at - 1);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    return fmt::format("{}:{}:{}", source, line, before.size() - line_start + 1);
}

// The opening of the line that is no JSON.
std::string opening_of(std::string_view text, std::size_t at) {
    constexpr std::size_t most = 20;
    if (text.empty()) return "an empty file";
    const std::string_view before = text.substr(0, at == 0 ? 0 : at - 1);
    const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    const std::string_view line = text.substr(line_start, text.find('\n', line_start) - line_start);
    return fmt::format("'{}{}', which is not JSON", visible_text(line.substr(0, most)),
                       line.size() > most ? "..." : "");
}

}  // namespace

Json read_json(std::string_view text, const std::string& source, std::string_view wanted) {
    if (text.size() > max_json_bytes) {
        raise<DataError>(
            "{}: read {} bytes of JSON, expected at most {}; draw its figure with --plot FILE.json", source,
            text.size(), max_json_bytes);
    }
    Builder builder;
    const char* seen = text.data();
    const Watched begin(text.data(), &seen), end(text.data() + text.size(), &seen);
    if (Json::sax_parse(begin, end, &builder)) return std::move(builder.document);
    const auto at = static_cast<std::size_t>(seen - text.data());
    const std::string place = place_in_text(text, at, source);
    if (!builder.refused.empty())
        raise<DataError>("{}: read {}, which no command writes; make the file again", place, builder.refused);
    if (!builder.number.empty()) {
        // A number is known to have ended one character behind it.
        raise<DataError>("{}: read {}, expected a number from -{} to {}; correct it or make the file again",
                         place_in_text(text, at - std::min(at, builder.number.size()), source),
                         builder.number, largest_json_number, largest_json_number);
    }
    raise<DataError>("{}: read {}, expected {}", place, opening_of(text, at), wanted);
}

}  // namespace ripplenotch
