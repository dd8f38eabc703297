// SPDX-License-Identifier: MIT
// Messages in JSON, by nlohmann's event parser.

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "log/messages/field_tree.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

/// What the parser meets, as a walk: nothing of the message is kept.
class Events {
  public:
    explicit Events(FieldVisitor& visitor) : visitor_(visitor) {}

    bool null() {
        return scalar([] {});
    }
    bool boolean(bool value) {
        return scalar([&] { visitor_.number({value ? 1.0 : 0.0, value ? 1 : 0, true}); });
    }
    bool number_integer(std::int64_t value) {
        return scalar([&] { visitor_.number({static_cast<double>(value), value, true}); });
    }
    bool number_unsigned(std::uint64_t value) {
        const bool fits = value <= static_cast<std::uint64_t>(INT64_MAX);
        return scalar([&] {
            visitor_.number({static_cast<double>(value), fits ? static_cast<std::int64_t>(value) : 0, fits});
        });
    }
    bool number_float(double value, const std::string& /*text*/) {
        return scalar([&] { visitor_.number({value, 0, false}); });
    }
    bool string(const std::string& value) {
        return scalar([&] { visitor_.text(value); });
    }
    bool binary(const std::vector<std::uint8_t>& /*value*/) {
        return scalar([] {});
    }
    bool start_object(std::size_t /*size*/) { return start(false); }
    bool start_array(std::size_t /*size*/) { return start(true); }
    bool key(const std::string& name) {
        visitor_.field(name);
        return true;
    }
    bool end_object() { return end(); }
    bool end_array() { return end(); }
    bool parse_error(std::size_t position, const std::string& /*token*/,
                     const nlohmann::json::exception& /*error*/) {
        raise<DataError>("byte {} of a message in JSON, where it is none, expected an object", position);
    }

  private:
    bool start(bool list) {
        if (lists_.empty() && list) raise<DataError>("a list as a message in JSON, expected an object");
        if (lists_.size() == deepest_field)
            raise<DataError>("lists and objects deeper than {} in a message in JSON", deepest_field);
        if (!lists_.empty() && lists_.back()) visitor_.element();
        lists_.push_back(list);
        return true;
    }
    bool end() {
        lists_.pop_back();
        if (!lists_.empty()) visitor_.leave();
        return true;
    }
    template <typename Value>
    bool scalar(Value value) {
        if (lists_.empty()) raise<DataError>("a message in JSON that is no object");
        if (lists_.back()) visitor_.element();
        value();
        visitor_.leave();
        return true;
    }

    FieldVisitor& visitor_;
    std::vector<bool> lists_;  ///< of what is open: whether it is a list
};

class JsonWalk final : public FieldWalk {
  public:
    void walk(std::string_view message, FieldVisitor& visitor) const override {
        Events events(visitor);
        nlohmann::json::sax_parse(message.begin(), message.end(), &events);
    }
};

}  // namespace

std::shared_ptr<const FieldWalk> json_walk() { return std::make_shared<JsonWalk>(); }

}  // namespace ripplenotch
