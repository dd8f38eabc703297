// SPDX-License-Identifier: MIT
// Messages in CDR (OMG's Common Data Representation, version 1, as ROS 2 writes it): which numbers are in the
// first of a topic, and a short program that takes them out of the next million.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <string_view>

#include "log/messages/message_columns.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

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
};

constexpr int deepest_message = 16;
constexpr std::size_t longest_array = 100000, most_fields = 10000;

struct Primitive {
    std::string_view name;
    char kind;
    std::size_t size;
};
constexpr std::array primitives = {
    Primitive{"bool", 'u', 1},    Primitive{"byte", 'u', 1},   Primitive{"char", 'u', 1},
    Primitive{"int8", 'i', 1},    Primitive{"uint8", 'u', 1},  Primitive{"int16", 'i', 2},
    Primitive{"uint16", 'u', 2},  Primitive{"int32", 'i', 4},  Primitive{"uint32", 'u', 4},
    Primitive{"int64", 'i', 8},   Primitive{"uint64", 'u', 8}, Primitive{"float32", 'f', 4},
    Primitive{"float64", 'f', 8},
};

// sensor_msgs/msg/JointState and sensor_msgs/JointState are one.
std::string plain_name(std::string_view type) {
    std::string name(type);
    if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
    return name;
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

class SchemaParser {
  public:
    SchemaParser(std::string_view schema, const std::string& type) {
        std::string name = plain_name(type);
        std::string_view rest = schema;
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            const std::string_view line = trimmed(rest.substr(0, end));
            rest.remove_prefix(std::min(end + 1, rest.size()));
            if (line.starts_with("====")) continue;
            if (line.starts_with("MSG:")) {
                name = plain_name(trimmed(line.substr(4)));
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
        line = trimmed(line.substr(0, std::min(line.find('#'), line.size())));
        if (line.empty()) return;
        const std::size_t blank = line.find_first_of(" \t");
        if (blank == std::string_view::npos)
            raise<DataError>("the type {} has a line '{}', expected a field", name, line);
        const std::string_view type = line.substr(0, blank);
        const std::string_view rest = trimmed(line.substr(blank));
        const std::size_t end = rest.find_first_of(" \t=");
        const std::string_view word = rest.substr(0, end);
        // A constant: NAME=value.
        if (end != std::string_view::npos && trimmed(rest.substr(end)).starts_with('=')) return;
        if (++fields_ > most_fields)
            raise<DataError>("the type {} has more than {} fields", name, most_fields);
        RosField field;
        field.name = word;
        field.type = type_of(read_count(type, field), name, depth);
        into.fields.push_back(std::move(field));
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
        const auto primitive =
            std::ranges::find_if(primitives, [&](const Primitive& one) { return one.name == word; });
        if (primitive != primitives.end()) {
            type.number = primitive->kind;
            type.size = primitive->size;
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

/// One step through a message.
struct CdrStep {
    enum class Kind {
        number,    ///< of `size` bytes, kept
        stamp,     ///< of eight bytes, kept
        skip,      ///< `count` numbers of `size` bytes
        skip_any,  ///< as many as stand in front
        text,
        text_is,     ///< `expected`
        length_is,   ///< `count` in front of a sequence
        repeat_any,  ///< `inner`, as many times as stand in front
    };
    Kind kind = Kind::skip;
    std::size_t size = 0, count = 1, leaf = 0;
    NpyField type = {};  ///< of a number that is kept
    std::string path, expected;
    std::vector<CdrStep> inner;
};

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
    // The length of a list whose elements take a byte or more each.
    std::uint32_t list_length() {
        const std::uint32_t count = length();
        if (count > bytes_.size() - at_)
            raise<DataError>("a list of {} things in the {} bytes that are left of a message, expected fewer",
                             count, bytes_.size() - at_);
        return count;
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

// Reads on over what a step says, and checks what it demands.
void pass_cdr(CdrCursor& cursor, const CdrStep& step);

void pass_cdr(CdrCursor& cursor, const std::vector<CdrStep>& steps) {
    for (const CdrStep& step : steps) pass_cdr(cursor, step);
}

void pass_cdr(CdrCursor& cursor, const CdrStep& step) {
    switch (step.kind) {
        case CdrStep::Kind::number:
            cursor.take(step.size);
            break;
        case CdrStep::Kind::stamp:
            cursor.take(4, 2);
            break;
        case CdrStep::Kind::skip:
            if (step.count > 0) cursor.take(step.size, step.count);
            break;
        case CdrStep::Kind::skip_any:
            if (const std::uint32_t count = cursor.length(); count > 0) cursor.take(step.size, count);
            break;
        case CdrStep::Kind::text:
            cursor.text();
            break;
        case CdrStep::Kind::text_is:
            if (const std::string_view text = cursor.text(); text != step.expected)
                raise<DataError>(
                    "'{}' as {}, expected '{}' as in the first message; record the joints on topics of their "
                    "own",
                    text.substr(0, 60), step.path, step.expected);
            break;
        case CdrStep::Kind::length_is:
            if (const std::uint32_t count = cursor.length(); count != step.count)
                raise<DataError>(
                    "{} elements of {}, expected {} as in the first message; record messages of one shape on "
                    "a topic",
                    count, step.path, step.count);
            break;
        case CdrStep::Kind::repeat_any:
            for (std::uint32_t left = cursor.list_length(); left > 0; --left) pass_cdr(cursor, step.inner);
            break;
    }
}

bool keeps(const CdrStep& step) {
    return step.kind == CdrStep::Kind::number || step.kind == CdrStep::Kind::stamp;
}

class CdrReader final : public MessageReader {
  public:
    CdrReader(std::shared_ptr<const std::vector<CdrStep>> steps, const std::vector<bool>& wanted)
        : steps_(std::move(steps)), count_(steps_->size()), wanted_(wanted) {
        // Behind the last useful step there is nothing to go on for.
        const auto useful = [&](const CdrStep& step) {
            return keeps(step) ? wanted_[step.leaf] : step.kind == CdrStep::Kind::length_is;
        };
        while (count_ > 0 && !useful((*steps_)[count_ - 1])) --count_;
    }
    void read(std::string_view message, std::vector<LeafNumber>& into) override {
        CdrCursor cursor(message);
        for (std::size_t s = 0; s < count_; ++s) {
            const CdrStep& step = (*steps_)[s];
            if (!keeps(step) || !wanted_[step.leaf]) {
                pass_cdr(cursor, step);
                continue;
            }
            std::array<char, 8> raw{};
            if (step.kind == CdrStep::Kind::number)
                cursor.number(step.size, raw.data());
            else
                raw = std::bit_cast<std::array<char, 8>>(cursor.stamp());
            into[step.leaf].value = load_field(raw.data(), step.type);
            if (step.type.whole()) into[step.leaf].count = load_count(raw.data(), step.type);
        }
    }

  private:
    std::shared_ptr<const std::vector<CdrStep>> steps_;
    std::size_t count_;
    std::vector<bool> wanted_;  ///< by leaf
};

constexpr std::size_t most_leaves = 4096, most_steps = 100000;

/// Goes through the first message and writes down the way.
class LayOut {
  public:
    explicit LayOut(std::string_view message) : cursor_(message) {}
    void record(const RosType& type, const std::string& prefix, std::vector<CdrStep>& steps) {
        const std::vector<std::string>* const outer = names_;
        std::vector<std::string> names;
        names_ = nullptr;
        for (const RosField& field : type.fields) {
            const bool joint_names =
                field.name == "name" || field.name == "joint_names" || field.name == "names";
            const bool texts = field.type.kind == RosType::Kind::text && field.count == RosField::Count::any;
            if (joint_names && texts) {
                take_names(prefix + field.name, names, steps);
                names_ = &names;
            } else {
                add_field(field, prefix + field.name, steps);
            }
        }
        names_ = outer;
    }
    std::vector<MessageLeaf> leaves;

  private:
    void take_names(const std::string& path, std::vector<std::string>& names, std::vector<CdrStep>& steps) {
        const std::uint32_t count = cursor_.length();
        if (count > 10000) raise<DataError>("{} names of joints", count);
        steps.push_back({CdrStep::Kind::length_is, 0, count, 0, {}, path, {}, {}});
        for (std::uint32_t i = 0; i < count; ++i) {
            names.emplace_back(cursor_.text());
            steps.push_back(
                {CdrStep::Kind::text_is, 0, 1, 0, {}, fmt::format("{}[{}]", path, i), names.back(), {}});
        }
    }
    void add_field(const RosField& field, const std::string& path, std::vector<CdrStep>& steps) {
        if (field.count == RosField::Count::one) return add_one(field.type, path, path, steps);
        const bool any = field.count == RosField::Count::any;
        CdrCursor ahead = cursor_;
        const std::size_t count = any ? ahead.length() : field.fixed;
        const bool listed =
            count > 0 && count <= most_listed_elements && field.type.kind != RosType::Kind::text;
        if (!listed) return pass_over(field, steps);
        if (any) {
            cursor_.length();
            steps.push_back({CdrStep::Kind::length_is, 0, count, 0, {}, path, {}, {}});
        }
        for (std::size_t i = 0; i < count; ++i) {
            const bool named = names_ != nullptr && names_->size() == count;
            add_one(field.type, fmt::format("{}[{}]", path, i),
                    named ? fmt::format("{} {}", (*names_)[i], field.name) : fmt::format("{}[{}]", path, i),
                    steps);
        }
    }
    void add_one(const RosType& type, const std::string& path, const std::string& read_as,
                 std::vector<CdrStep>& steps) {
        CdrStep step;
        step.path = path;
        switch (type.kind) {
            case RosType::Kind::record:
                return record(type, path + ".", steps);
            case RosType::Kind::wide_text:
                raise<DataError>("the field {} of wide text, which is not read", path);
            case RosType::Kind::text:
                step.kind = CdrStep::Kind::text;
                break;
            case RosType::Kind::number:
            case RosType::Kind::stamp: {
                const bool stamp = type.kind == RosType::Kind::stamp;
                step.kind = stamp ? CdrStep::Kind::stamp : CdrStep::Kind::number;
                step.size = type.size;
                step.leaf = leaves.size();
                MessageLeaf leaf{path, read_as, {}, stamp, path == "header.stamp"};
                leaf.type.kind = stamp ? 'i' : type.number;
                leaf.type.size = stamp ? 8 : type.size;
                leaf.type.big_endian = std::endian::native == std::endian::big;
                if (leaves.size() == most_leaves)
                    raise<DataError>("messages of more than {} numbers", most_leaves);
                step.type = leaf.type;
                leaves.push_back(leaf);
                break;
            }
        }
        pass_cdr(cursor_, step);
        steps.push_back(std::move(step));
    }
    // Without leaves, whatever its length in the next message.
    void pass_over(const RosField& field, std::vector<CdrStep>& steps) {
        const std::vector<CdrStep> passing = steps_without_leaves(field);
        pass_cdr(cursor_, passing);
        append(passing, steps);
    }
    static void append(const std::vector<CdrStep>& more, std::vector<CdrStep>& steps) {
        steps.insert(steps.end(), more.begin(), more.end());
        if (steps.size() > most_steps) raise<DataError>("messages of more than {} fields", most_steps);
    }
    static std::vector<CdrStep> steps_without_leaves(const RosField& field) {
        const bool any = field.count == RosField::Count::any;
        const std::size_t count = field.count == RosField::Count::fixed ? field.fixed : 1;
        CdrStep step;
        std::vector<CdrStep> one;
        switch (field.type.kind) {
            case RosType::Kind::number:
                step.kind = any ? CdrStep::Kind::skip_any : CdrStep::Kind::skip;
                step.size = field.type.size;
                step.count = count;
                return {step};
            case RosType::Kind::wide_text:
                raise<DataError>("the field {} of wide text, which is not read", field.name);
            case RosType::Kind::text:
                step.kind = CdrStep::Kind::text;
                one = {step};
                break;
            case RosType::Kind::stamp:
                step.size = 4;
                step.count = 2;
                one = {step};
                break;
            case RosType::Kind::record:
                for (const RosField& inner : field.type.fields) append(steps_without_leaves(inner), one);
                break;
        }
        if (any) {
            step.kind = CdrStep::Kind::repeat_any;
            step.inner = std::move(one);
            return {step};
        }
        std::vector<CdrStep> steps;
        for (std::size_t i = 0; i < count; ++i) append(one, steps);
        return steps;
    }

    CdrCursor cursor_;
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
    const RosType type = parse_ros_schema(schema, name);
    std::vector<CdrStep> steps;
    LayOut work(message);
    work.record(type, "", steps);
    const auto shared = std::make_shared<const std::vector<CdrStep>>(std::move(steps));
    return {std::move(work.leaves),
            [shared](const std::vector<bool>& wanted) -> std::unique_ptr<MessageReader> {
                return std::make_unique<CdrReader>(shared, wanted);
            }};
}

}  // namespace ripplenotch
