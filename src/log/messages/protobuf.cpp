// SPDX-License-Identifier: MIT
// Messages in Protobuf and the definitions of their types.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "log/messages/field_tree.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

// The bytes of Protobuf messages: fields, each behind its number and the kind of its size (protobuf.dev,
// "Encoding").

struct WireField {
    enum class Size { varint = 0, eight = 1, counted = 2, four = 5 };
    std::uint32_t number = 0;
    Size size = Size::varint;
    std::uint64_t bits = 0;  ///< but for counted ones
    std::string_view bytes;  ///< of counted ones
};

class WireCursor {
  public:
    explicit WireCursor(std::string_view bytes) : bytes_(bytes) {}
    [[nodiscard]] bool at_end() const { return bytes_.empty(); }

    /// Throws DataError, without a source's name, where the bytes end or are no field.
    WireField next() {
        const std::uint64_t tag = varint();
        WireField field;
        field.number = static_cast<std::uint32_t>(tag >> 3);
        if (tag >> 32 != 0 || field.number == 0)
            raise<DataError>("a field without a number in a message of Protobuf");
        switch (tag & 7) {
            case 0:
                field.bits = varint();
                break;
            case 1:
                field.bits = fixed(8);
                break;
            case 2:
                field.bytes = counted(varint());
                break;
            case 5:
                field.bits = fixed(4);
                break;
            default:
                raise<DataError>("field {} of a group, which is not read", field.number);
        }
        field.size = static_cast<WireField::Size>(tag & 7);
        return field;
    }
    std::uint64_t varint() {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 64; shift += 7) {
            const auto byte = static_cast<unsigned char>(counted(1)[0]);
            value |= std::uint64_t{byte & 0x7fU} << shift;
            if ((byte & 0x80U) == 0) return value;
        }
        raise<DataError>("a whole number of more than ten bytes in a message of Protobuf");
    }
    /// Little endian, of 4 or 8 bytes.
    std::uint64_t fixed(std::size_t size) { return little_endian(counted(size)); }

  private:
    std::string_view counted(std::uint64_t size) {
        if (size > bytes_.size())
            raise<DataError>("a message of Protobuf that ends, expected {} bytes more", size - bytes_.size());
        const std::string_view bytes = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return bytes;
    }

    std::string_view bytes_;
};

// Types of Protobuf messages, as recordings carry them: a FileDescriptorSet (descriptor.proto of Protobuf).

struct ProtobufField {
    /// As numbered in descriptor.proto.
    enum class Type : std::uint32_t {
        float64 = 1,
        float32 = 2,
        int64 = 3,
        uint64 = 4,
        int32 = 5,
        fixed64 = 6,
        fixed32 = 7,
        boolean = 8,
        text = 9,
        group = 10,
        message = 11,
        bytes = 12,
        uint32 = 13,
        enumeration = 14,
        sfixed32 = 15,
        sfixed64 = 16,
        sint32 = 17,
        sint64 = 18
    };
    std::uint32_t number = 0;
    std::string name;
    Type type = Type::float64;
    bool repeated = false;
    bool zero_if_absent = false;  ///< proto3: what is not written is 0; else it is not there
    std::size_t inner = 0;        ///< of a message: its place among the types
};

using ProtobufType = std::vector<ProtobufField>;

using ProtobufTypes = std::vector<ProtobufType>;  ///< the first is the one that was asked for

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

/// Throws DataError, without a source's name, on bytes that are no such set, and where a type is not in it.
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
            types_.push_back(std::move(type));
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

using Type = ProtobufField::Type;
using Size = WireField::Size;

Size size_of(Type type) {
    switch (type) {
        case Type::float64:
        case Type::fixed64:
        case Type::sfixed64:
            return Size::eight;
        case Type::float32:
        case Type::fixed32:
        case Type::sfixed32:
            return Size::four;
        case Type::text:
        case Type::bytes:
        case Type::message:
        case Type::group:
            return Size::counted;
        default:
            return Size::varint;
    }
}

bool holds_number(Type type) { return size_of(type) != Size::counted; }

FieldNumber whole_field(std::int64_t value) { return {static_cast<double>(value), value, true}; }

FieldNumber number_of(Type type, std::uint64_t bits) {
    switch (type) {
        case Type::float64:
            return {std::bit_cast<double>(bits), 0, false};
        case Type::float32:
            return {static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))), 0, false};
        case Type::uint64:
        case Type::fixed64:
            if (bits > static_cast<std::uint64_t>(INT64_MAX)) return {static_cast<double>(bits), 0, false};
            return whole_field(static_cast<std::int64_t>(bits));
        case Type::uint32:
        case Type::fixed32:
            return whole_field(static_cast<std::uint32_t>(bits));
        case Type::int32:
        case Type::sfixed32:
        case Type::enumeration:
            return whole_field(static_cast<std::int32_t>(static_cast<std::uint32_t>(bits)));
        case Type::sint32:
        case Type::sint64:
            return whole_field(static_cast<std::int64_t>((bits >> 1) ^ (~(bits & 1) + 1)));
        case Type::boolean:
            return whole_field(bits != 0 ? 1 : 0);
        default:
            return whole_field(static_cast<std::int64_t>(bits));
    }
}

class ProtobufWalk final : public FieldWalk {
  public:
    explicit ProtobufWalk(ProtobufTypes types) : types_(std::move(types)) {}
    void walk(std::string_view message, FieldVisitor& visitor) const override {
        record(types_.front(), message, visitor, 0);
    }

  private:
    void record(const ProtobufType& type, std::string_view bytes, FieldVisitor& visitor,
                std::size_t depth) const {
        if (depth == deepest_field)
            raise<DataError>("messages deeper than {} in a message of Protobuf", deepest_field);
        std::vector<bool> seen(type.size());
        for (WireCursor cursor(bytes); !cursor.at_end();) {
            const WireField one = cursor.next();
            const auto field = std::find_if(type.begin(), type.end(), [&](const ProtobufField& known) {
                return known.number == one.number;
            });
            if (field == type.end()) continue;  // of a later version of the type
            seen[static_cast<std::size_t>(field - type.begin())] = true;
            visitor.field(field->name);
            values(*field, one, visitor, depth);
            visitor.leave();
        }
        for (std::size_t i = 0; i < type.size(); ++i) {
            if (seen[i] || !type[i].zero_if_absent || !holds_number(type[i].type)) continue;
            visitor.field(type[i].name);
            visitor.number({0.0, 0, true});
            visitor.leave();
        }
    }
    void values(const ProtobufField& field, const WireField& one, FieldVisitor& visitor,
                std::size_t depth) const {
        if (field.repeated && holds_number(field.type) && one.size == Size::counted) {
            for (WireCursor packed(one.bytes); !packed.at_end();) {
                visitor.element();
                visitor.number(number_of(field.type, next_of(field.type, packed)));
                visitor.leave();
            }
            return;
        }
        if (one.size != size_of(field.type))
            raise<DataError>("the field {} in bytes of another type than the recording defines", field.name);
        if (field.repeated) visitor.element();
        if (field.type == Type::message)
            record(types_[field.inner], one.bytes, visitor, depth + 1);
        else if (field.type == Type::text)
            visitor.text(one.bytes);
        else if (holds_number(field.type))
            visitor.number(number_of(field.type, one.bits));
        if (field.repeated) visitor.leave();
    }
    static std::uint64_t next_of(Type type, WireCursor& packed) {
        const Size size = size_of(type);
        return size == Size::varint ? packed.varint() : packed.fixed(size == Size::eight ? 8 : 4);
    }

    ProtobufTypes types_;
};

}  // namespace

std::shared_ptr<const FieldWalk> protobuf_walk(std::string_view descriptor_set, const std::string& type) {
    return std::make_shared<ProtobufWalk>(Schema(descriptor_set).types_of(type));
}

}  // namespace ripplenotch
