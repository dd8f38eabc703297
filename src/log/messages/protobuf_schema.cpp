// SPDX-License-Identifier: MIT
#include "log/messages/protobuf_schema.hpp"

#include <fmt/format.h>

#include <map>

#include "log/messages/protobuf_wire.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_declared_types = 10000, most_declared_fields = 10000, deepest_type = 32;

// Numbers of the fields of descriptor.proto.
namespace set {
constexpr std::uint32_t file = 1;
}
namespace file {
constexpr std::uint32_t package = 2, message = 4, syntax = 12;
}
namespace message {
constexpr std::uint32_t name = 1, field = 2, nested = 3;
}
namespace field {
constexpr std::uint32_t name = 1, number = 3, label = 4, type = 5, type_named = 6, oneof = 9, optional = 17;
constexpr std::uint64_t repeated = 3;
}  // namespace field

struct Declared {
    std::string_view bytes;
    bool proto3 = false;
};

class Schema {
  public:
    explicit Schema(std::string_view descriptor_set) {
        for (WireCursor cursor(descriptor_set); !cursor.at_end();)
            if (const WireField one = cursor.next(); one.number == set::file) add_file(one.bytes);
    }
    ProtobufTypes types_of(const std::string& name) {
        place_of(name);
        // Grows while types name others.
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            ProtobufType type = fields_of(asked_[i]);
            types_.types.push_back(std::move(type));
        }
        return std::move(types_);
    }

  private:
    void add_file(std::string_view bytes) {
        std::string package;
        bool proto3 = false;
        std::vector<std::string_view> messages;
        for (WireCursor cursor(bytes); !cursor.at_end();) {
            const WireField one = cursor.next();
            if (one.number == file::package) package = one.bytes;
            if (one.number == file::syntax) proto3 = one.bytes == "proto3";
            if (one.number == file::message) messages.push_back(one.bytes);
        }
        for (const std::string_view inner : messages) add_message(inner, package, proto3, 0);
    }
    void add_message(std::string_view bytes, const std::string& outer, bool proto3, std::size_t depth) {
        if (depth > deepest_type) raise<DataError>("types that hold types deeper than {}", deepest_type);
        if (declared_.size() == most_declared_types)
            raise<DataError>("more than {} types", most_declared_types);
        std::string name = outer;
        std::vector<std::string_view> nested;
        for (WireCursor cursor(bytes); !cursor.at_end();) {
            const WireField one = cursor.next();
            if (one.number == message::name)
                name = outer.empty() ? one.bytes : fmt::format("{}.{}", outer, one.bytes);
            if (one.number == message::nested) nested.push_back(one.bytes);
        }
        declared_[name] = {bytes, proto3};
        for (const std::string_view inner : nested) add_message(inner, name, proto3, depth + 1);
    }
    ProtobufType fields_of(const std::string& name) {
        const auto found = declared_.find(name);
        if (found == declared_.end()) raise<DataError>("the type {} is not defined in the recording", name);
        ProtobufType type;
        for (WireCursor cursor(found->second.bytes); !cursor.at_end();) {
            const WireField one = cursor.next();
            if (one.number == message::field) type.push_back(field_of(one.bytes, found->second.proto3));
            if (type.size() > most_declared_fields)
                raise<DataError>("the type {} has more than {} fields", name, most_declared_fields);
        }
        return type;
    }
    ProtobufField field_of(std::string_view bytes, bool proto3) {
        ProtobufField made;
        std::string type_name;
        bool explicit_presence = !proto3;
        for (WireCursor cursor(bytes); !cursor.at_end();) {
            const WireField one = cursor.next();
            if (one.number == field::name) made.name = one.bytes;
            if (one.number == field::number) made.number = static_cast<std::uint32_t>(one.bits);
            if (one.number == field::label) made.repeated = one.bits == field::repeated;
            if (one.number == field::type) {
                if (one.bits < 1 || one.bits > 18)
                    raise<DataError>("a field of type {}, expected 1 to 18", one.bits);
                made.type = static_cast<ProtobufField::Type>(one.bits);
            }
            if (one.number == field::type_named) type_name = one.bytes;
            if (one.number == field::oneof || one.number == field::optional) explicit_presence = true;
        }
        if (made.type == ProtobufField::Type::message)
            made.inner = place_of(type_name.starts_with('.') ? type_name.substr(1) : type_name);
        made.zero_if_absent = !explicit_presence && !made.repeated;
        return made;
    }
    std::size_t place_of(const std::string& name) {
        const auto [place, is_new] = places_.emplace(name, asked_.size());
        if (is_new) asked_.push_back(name);
        return place->second;
    }

    std::map<std::string, Declared> declared_;
    std::map<std::string, std::size_t> places_;
    std::vector<std::string> asked_;
    ProtobufTypes types_;
};

}  // namespace

ProtobufTypes parse_protobuf_schema(std::string_view descriptor_set, const std::string& type) {
    return Schema(descriptor_set).types_of(type);
}

}  // namespace ripplenotch
