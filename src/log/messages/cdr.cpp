// SPDX-License-Identifier: MIT
// Messages in CDR (OMG's Common Data Representation, version 1, as ROS 2 writes it): which numbers are in the
// first of a topic, and how they are taken out of the next million.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "log/columns/units.hpp"
#include "log/messages/message_columns.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace {

// Definitions of ROS 2 messages in the language of .msg files, as recordings carry them (encoding ros2msg).

struct RosField;

/// What a field holds.
struct RosType {
    enum class Kind { number, text, wide_text, stamp, record };
    Kind kind = Kind::number;
    char number = 'f';     ///< as NpyField::kind
    std::size_t size = 0;  ///< of a number in bytes
    std::vector<RosField> fields;
};

struct RosField {
    enum class Count { one, fixed, any };
    std::string name;
    RosType type;
    Count count = Count::one;
    std::size_t fixed = 1;
    /// The names of joints, to which the lists behind it belong.
    [[nodiscard]] bool names_joints() const {
        return type.kind == RosType::Kind::text && count == Count::any &&
               (name == "name" || name == "joint_names" || name == "names");
    }
    /// Nothing stands in the message, however often.
    [[nodiscard]] bool is_empty() const {
        const bool nothing = type.kind == RosType::Kind::record && type.fields.empty();
        return count == Count::any ? false : nothing || fixed == 0;
    }
};

constexpr int deepest_message = 16;
constexpr std::size_t longest_array = 100000, most_fields = 10000;

// sensor_msgs/msg/JointState and sensor_msgs/JointState are one.
std::string plain_name(std::string_view type) {
    std::string name(type);
    if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
    return name;
}

std::string_view without_blanks(std::string_view text) { return trimmed(text, " \t\r"); }

class SchemaParser {
  public:
    SchemaParser(std::string_view schema, const std::string& type) {
        std::string name = plain_name(type);
        for (const std::string_view text : split(schema, '\n')) {
            const std::string_view line = without_blanks(text);
            if (line.starts_with("====")) continue;
            if (line.starts_with("MSG:")) {
                name = plain_name(without_blanks(line.substr(4)));
                definitions_[name];
                continue;
            }
            definitions_[name].push_back(line);
        }
    }
    RosType record(const std::string& name, int depth) {
        if (depth > deepest_message)
            raise<DataError>("the type {} holds itself, or types deeper than {}", name, deepest_message);
        const auto found = definitions_.find(name);
        if (found == definitions_.end())
            raise<DataError>("the type {} is not defined in the recording", name);
        RosType type;
        type.kind = RosType::Kind::record;
        for (const std::string_view line : found->second) read_line(line, name, type, depth);
        return type;
    }

  private:
    void read_line(std::string_view line, const std::string& name, RosType& into, int depth) {
        line = without_blanks(line.substr(0, std::min(line.find('#'), line.size())));
        if (line.empty()) return;
        const std::size_t blank = line.find_first_of(" \t");
        if (blank == std::string_view::npos)
            raise<DataError>("the type {} has a line '{}', expected a field", name, line);
        const std::string_view type = line.substr(0, blank);
        const std::string_view rest = without_blanks(line.substr(blank));
        const std::size_t end = rest.find_first_of(" \t=");
        const std::string_view word = rest.substr(0, end);
        // A constant: NAME=value.
        if (end != std::string_view::npos && without_blanks(rest.substr(end)).starts_with('=')) return;
        if (++fields_ > most_fields)
            raise<DataError>("the type {} has more than {} fields", name, most_fields);
        RosField field;
        field.name = word;
        field.type = type_of(read_count(type, field), name, depth);
        if (!field.is_empty()) into.fields.push_back(std::move(field));
    }
    // Without "[]", "[3]", "[<=3]" and the "<=10" of a string.
    static std::string_view read_count(std::string_view type, RosField& field) {
        const std::size_t bracket = type.find('[');
        std::string_view base = type.substr(0, bracket);
        base = base.substr(0, base.find("<="));
        if (bracket == std::string_view::npos) return base;
        const std::string_view inside = type.substr(bracket + 1, type.size() - bracket - 2);
        const auto number = parse_number(inside);
        field.count = number ? RosField::Count::fixed : RosField::Count::any;
        if (number && !(*number >= 0.0 && *number <= static_cast<double>(longest_array)))
            raise<DataError>("an array {} is longer than {}", type, longest_array);
        if (number) field.fixed = static_cast<std::size_t>(*number);
        return base;
    }
    RosType type_of(std::string_view word, const std::string& inside, int depth) {
        RosType type;
        const bool byte = word == "bool" || word == "byte" || word == "char";
        if (const auto number = word.size() < 3 ? std::nullopt : number_type(byte ? "uint8" : word)) {
            type.number = number->kind;
            type.size = number->size;
            return type;
        }
        if (word == "string" || word == "wstring") {
            type.kind = word == "string" ? RosType::Kind::text : RosType::Kind::wide_text;
            return type;
        }
        const std::string name = full_name(plain_name(word), inside);
        if (name == "builtin_interfaces/Time" || name == "builtin_interfaces/Duration") {
            type.kind = RosType::Kind::stamp;
            return type;
        }
        return record(name, depth + 1);
    }
    std::string full_name(const std::string& name, const std::string& inside) const {
        if (name == "time" || name == "Time") return "builtin_interfaces/Time";
        if (name == "duration" || name == "Duration") return "builtin_interfaces/Duration";
        if (name.find('/') != std::string::npos) return name;
        const std::string beside = inside.substr(0, inside.find('/') + 1) + name;
        return definitions_.count(beside) == 0 && name == "Header" ? "std_msgs/Header" : beside;
    }

    std::map<std::string, std::vector<std::string_view>> definitions_;
    std::size_t fields_ = 0;
};

struct KnownSchema {
    std::string_view type, schema;
};
// Recordings before ROS 2 Iron do not carry definitions. These are the fields of common types, in their
// order.
constexpr std::string_view header_schema =
    "\n====\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr std::array known_schemas = {
    KnownSchema{
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"},
    KnownSchema{
        "geometry_msgs/WrenchStamped",
        "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n====\nMSG: geometry_msgs/Wrench\n"
        "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n====\nMSG: geometry_msgs/Vector3\n"
        "float64 x\nfloat64 y\nfloat64 z\n"},
    KnownSchema{"std_msgs/Float64", "float64 data\n"},
    KnownSchema{"std_msgs/Float32", "float32 data\n"},
    KnownSchema{
        "std_msgs/Float64MultiArray",
        "std_msgs/MultiArrayLayout layout\nfloat64[] data\n====\nMSG: std_msgs/MultiArrayLayout\n"
        "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n====\nMSG: std_msgs/MultiArrayDimension\n"
        "string label\nuint32 size\nuint32 stride\n"},
};

// The fields of `type`, defined first in `schema`, with those of the types behind it put in place. Throws
// DataError, without a source's name, on a type that is not defined, on one that holds itself, and on lines
// that are no fields.
RosType parse_ros_schema(std::string_view schema, const std::string& type) {
    const std::string whole = std::string(schema) + std::string(header_schema);
    return SchemaParser(schema.find("MSG: std_msgs/") != std::string_view::npos ? schema : whole, type)
        .record(plain_name(type), 0);
}

// Where a message in CDR is read: numbers at multiples of their size, texts and lists behind their lengths.

constexpr std::size_t cdr_head = 4;  // says the byte order

/// Throws DataError, without a source's name, where the message ends.
class CdrCursor {
  public:
    explicit CdrCursor(std::string_view message) : bytes_(message) {
        if (message.size() < cdr_head)
            raise<DataError>("a message of {} bytes, expected 4 or more", message.size());
        if (message[0] != '\0' || (message[1] != '\0' && message[1] != '\1'))
            raise<DataError>("a message in another encoding of CDR ({:#04x} {:#04x}), expected version 1",
                             static_cast<unsigned char>(message[0]), static_cast<unsigned char>(message[1]));
        swaps_ = (message[1] == '\0') != (std::endian::native == std::endian::big);
        bytes_.remove_prefix(cdr_head);
    }
    // Numbers stand at multiples of their size.
    const char* take(std::size_t size, std::size_t count = 1) {
        const std::size_t at = (at_ + size - 1) & ~(size - 1);
        if (at > bytes_.size() || count > (bytes_.size() - at) / size)
            raise<DataError>("a message that ends after {} bytes, expected {} numbers of {} bytes more",
                             bytes_.size() + cdr_head, count, size);
        at_ = at + count * size;
        return bytes_.data() + at;
    }
    void number(std::size_t size, char* into) {
        const char* const from = take(size);
        if (swaps_)
            std::reverse_copy(from, from + size, into);
        else
            std::memcpy(into, from, size);
    }
    std::uint32_t length() {
        std::uint32_t value = 0;
        number(4, reinterpret_cast<char*>(&value));
        return value;
    }
    // There may be so many elements, of a byte or more each.
    void require(std::size_t count) const {
        if (count > bytes_.size() - at_)
            raise<DataError>("a list of {} things in the {} bytes that are left of a message, expected fewer",
                             count, bytes_.size() - at_);
    }
    std::string_view text() {
        const std::uint32_t size = length();
        std::string_view text(take(1, size), size);
        if (text.ends_with('\0')) text.remove_suffix(1);
        return text;
    }
    std::int64_t stamp() {
        std::int32_t seconds = 0;
        std::uint32_t nanoseconds = 0;
        number(4, reinterpret_cast<char*>(&seconds));
        number(4, reinterpret_cast<char*>(&nanoseconds));
        return std::int64_t{seconds} * 1'000'000'000 + nanoseconds;
    }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool swaps_ = false;
};

constexpr std::size_t most_leaves = 4096, most_names_of_joints = 10000;

/// What the first message of a topic says of all that follow, in the order in which it stands in them.
struct CdrShape {
    struct List {
        std::string path;
        std::optional<std::size_t> length;  ///< none: it may be of any, and is no columns
    };
    struct Name {
        std::string path, text;
    };
    RosType type;
    std::vector<MessageLeaf> leaves;
    std::vector<List> lists;  ///< without a length in their type
    std::vector<Name> names;  ///< of joints
};

/// Goes through a message by its type. Paths are put together for the first one alone.
class CdrWalk {
  public:
    /// The first message.
    CdrWalk(std::string_view message, CdrShape& shape) : cursor_(message), shape_(shape), first_(&shape) {}
    /// Another one, which has to be like the first. It is left when `useful` lists and wanted leaves have
    /// been seen.
    CdrWalk(std::string_view message, const CdrShape& shape, std::size_t useful,
            const std::vector<bool>& wanted, std::vector<LeafNumber>& into)
        : cursor_(message), shape_(shape), left_(useful), wanted_(&wanted), into_(&into) {}

    void record(const RosType& type, const std::string& prefix) {
        const std::vector<std::string>* const outer = std::exchange(names_, nullptr);
        std::vector<std::string> names;
        for (const RosField& field : type.fields) {
            if (left_ == 0) break;
            const std::string path = first_ != nullptr ? prefix + field.name : std::string();
            if (field.names_joints() && !passing_) {
                take_names(path, names);
                names_ = &names;
            } else {
                take(field, path);
            }
        }
        names_ = outer;
    }

  private:
    void take_names(const std::string& path, std::vector<std::string>& names) {
        const std::uint32_t count = cursor_.length();
        if (first_ != nullptr && count > most_names_of_joints) raise<DataError>("{} names of joints", count);
        check_length(path, count, true);
        for (std::uint32_t i = 0; i < count && left_ > 0; ++i) {
            const std::string_view text = cursor_.text();
            if (first_ != nullptr) {
                first_->names.push_back({fmt::format("{}[{}]", path, i), names.emplace_back(text)});
                continue;
            }
            const CdrShape::Name& known = shape_.names[name_++];
            if (text != known.text) refuse_name(text, known.path, known.text);
        }
    }
    void take(const RosField& field, const std::string& path) {
        if (field.count == RosField::Count::one) return one(field, path, path);
        const bool any = field.count == RosField::Count::any;
        const std::size_t count = any ? cursor_.length() : field.fixed;
        bool listed = !passing_ && field.type.kind != RosType::Kind::text;
        const bool columns = count > 0 && count <= most_listed_elements;
        if (listed) listed = any ? check_length(path, count, columns) : columns;
        if (!listed) return pass_over(field, count);
        const bool named = names_ != nullptr && names_->size() == count;
        for (std::size_t i = 0; i < count && left_ > 0; ++i) {
            if (first_ == nullptr) {
                one(field, path, path);
                continue;
            }
            const std::string element = fmt::format("{}[{}]", path, i);
            one(field, element, named ? fmt::format("{} {}", (*names_)[i], field.name) : element);
        }
    }
    /// Whether the elements of the next list are columns, as in the first message.
    bool check_length(const std::string& path, std::size_t count, bool columns) {
        if (first_ != nullptr) {
            first_->lists.push_back({path, columns ? std::optional(count) : std::nullopt});
            return columns;
        }
        const CdrShape::List& list = shape_.lists[list_++];
        if (!list.length) return false;
        if (count != *list.length) refuse_length(count, list.path, *list.length);
        --left_;
        return true;
    }
    // Without leaves, whatever its length in the next message.
    void pass_over(const RosField& field, std::size_t count) {
        const bool outer = std::exchange(passing_, true);
        if (field.type.kind == RosType::Kind::number) {
            if (count > 0) cursor_.take(field.type.size, count);
        } else {
            if (field.count == RosField::Count::any) cursor_.require(count);
            for (; count > 0; --count) one(field, field.name, "");
        }
        passing_ = outer;
    }
    void one(const RosField& field, const std::string& path, const std::string& read_as) {
        const RosType& type = field.type;
        const bool stamp = type.kind == RosType::Kind::stamp;
        if (type.kind == RosType::Kind::record) return record(type, first_ != nullptr ? path + "." : path);
        if (type.kind == RosType::Kind::wide_text)
            raise<DataError>("the field {} of wide text, which is not read",
                             path.empty() ? field.name : path);
        if (type.kind == RosType::Kind::text) {
            cursor_.text();
            return;
        }
        if (!passing_ && first_ != nullptr) add_leaf(type, path, read_as);
        const std::size_t leaf = passing_ ? 0 : leaf_++;
        if (passing_ || first_ != nullptr || !(*wanted_)[leaf]) {
            stamp ? cursor_.take(4, 2) : cursor_.take(type.size);
            return;
        }
        std::array<char, 8> raw{};
        if (stamp)
            raw = std::bit_cast<std::array<char, 8>>(cursor_.stamp());
        else
            cursor_.number(type.size, raw.data());
        const NpyField& kept = shape_.leaves[leaf].type;
        (*into_)[leaf].value = load_field(raw.data(), kept);
        if (kept.whole()) (*into_)[leaf].count = load_count(raw.data(), kept);
        --left_;
    }
    void add_leaf(const RosType& type, const std::string& path, const std::string& read_as) {
        if (first_->leaves.size() == most_leaves)
            raise<DataError>("messages of more than {} numbers", most_leaves);
        const bool stamp = type.kind == RosType::Kind::stamp;
        MessageLeaf leaf{path, read_as, {}, stamp, path == "header.stamp"};
        leaf.type.kind = stamp ? 'i' : type.number;
        leaf.type.size = stamp ? 8 : type.size;
        leaf.type.big_endian = std::endian::native == std::endian::big;
        first_->leaves.push_back(std::move(leaf));
    }

    CdrCursor cursor_;
    const CdrShape& shape_;
    CdrShape* first_ = nullptr;  ///< of the first message: what it says
    std::size_t left_ = 1;       ///< of another: what is useful and was not seen yet
    const std::vector<bool>* wanted_ = nullptr;
    std::vector<LeafNumber>* into_ = nullptr;
    std::size_t leaf_ = 0, list_ = 0, name_ = 0;       ///< the next of the shape
    bool passing_ = false;                             ///< over what gives no leaves
    const std::vector<std::string>* names_ = nullptr;  ///< of joints, in the record that is laid out
};

}  // namespace

std::string_view known_ros_schema(std::string_view type) {
    const std::string name = plain_name(type);
    for (const KnownSchema& known : known_schemas)
        if (known.type == name) return known.schema;
    return {};
}

MessageLayout lay_out_cdr(std::string_view schema, const std::string& name, std::string_view message) {
    const auto shape = std::make_shared<CdrShape>();
    shape->type = parse_ros_schema(schema, name);
    CdrWalk(message, *shape).record(shape->type, "");
    const auto lists = std::ranges::count_if(shape->lists, [](const auto& list) { return !!list.length; });
    return {shape->leaves, [shape, lists](std::string_view next, const std::vector<bool>& wanted,
                                          std::vector<LeafNumber>& into) {
                const auto useful = static_cast<std::size_t>(lists + std::ranges::count(wanted, true));
                CdrWalk(next, *shape, useful, wanted, into).record(shape->type, "");
            }};
}

}  // namespace ripplenotch
