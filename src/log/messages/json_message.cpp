// SPDX-License-Identifier: MIT
// Messages in JSON, by nlohmann's event parser: a walk through one tells what stands where, and a tree of the
// fields of the first message says which of it is kept from the next.

#include "log/messages/json_message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

/// How deep the records and lists of a message may lie in one another.
constexpr std::size_t deepest_field = 32;

struct FieldNumber {
    double value = 0.0;
    std::int64_t whole = 0;  ///< the same, where it is_whole
    bool is_whole = false;
};

/// What a walk through a message meets, in the order in which it stands there.
class FieldVisitor {
  public:
    virtual ~FieldVisitor() = default;
    /// What comes until leave() is the value of this field of the record that is visited.
    virtual void field(std::string_view name) = 0;
    /// What comes until leave() is the next element of the list that is visited.
    virtual void element() = 0;
    virtual void leave() = 0;
    virtual void number(const FieldNumber& number) = 0;
    virtual void text(std::string_view text) = 0;
};

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

/// Throws DataError, without a source's name, where the bytes are no such message.
void walk(std::string_view message, FieldVisitor& visitor) {
    Events events(visitor);
    nlohmann::json::sax_parse(message.begin(), message.end(), &events);
}

constexpr std::size_t most_named_fields = 16384;
constexpr std::int64_t largest_exact = std::int64_t{1} << 53;

/// A field of the first message, or an element of a list in it. Node 0 is the message.
struct Node {
    enum class Holds { nothing, number, text, record, list };
    Holds holds = Holds::nothing;
    std::string key;
    std::size_t above = 0;
    std::vector<std::size_t> inside;
    std::size_t elements = 0;  ///< of a list, also those that are not kept
    FieldNumber number;
    std::string text;
    std::optional<std::size_t> leaf;
    double nanoseconds = 0.0;  ///< in a unit of a part of a stamp; 0: the leaf is no stamp
    bool is_name = false;      ///< of a joint
};

using Nodes = std::vector<Node>;

std::string path_of(const Nodes& nodes, std::size_t at) {
    if (at == 0) return {};
    const Node& node = nodes[at];
    const std::string above = path_of(nodes, node.above);
    if (nodes[node.above].holds == Node::Holds::list) return fmt::format("{}[{}]", above, node.key);
    return above.empty() ? node.key : fmt::format("{}.{}", above, node.key);
}

/// Makes the tree of a first message.
class Grow final : public FieldVisitor {
  public:
    Nodes nodes = Nodes(1);

    void field(std::string_view name) override {
        nodes[at_].holds = Node::Holds::record;
        for (const std::size_t inside : nodes[at_].inside)
            if (nodes[inside].key == name) return enter(inside);
        enter(add(std::string(name)));
    }
    void element() override {
        nodes[at_].holds = Node::Holds::list;
        const std::size_t number = nodes[at_].elements++;
        if (number > most_listed_elements) return enter(nodes[at_].inside.back());
        enter(add(std::to_string(number)));
    }
    void leave() override { at_ = nodes[at_].above; }
    void number(const FieldNumber& number) override {
        nodes[at_].holds = Node::Holds::number;
        nodes[at_].number = number;
    }
    void text(std::string_view text) override {
        nodes[at_].holds = Node::Holds::text;
        nodes[at_].text = text;
    }

  private:
    std::size_t add(std::string key) {
        if (nodes.size() == most_named_fields)
            raise<DataError>("messages of more than {} fields", most_named_fields);
        Node node;
        node.key = std::move(key);
        node.above = at_;
        nodes[at_].inside.push_back(nodes.size());
        nodes.push_back(std::move(node));
        return nodes.size() - 1;
    }
    void enter(std::size_t node) { at_ = node; }

    std::size_t at_ = 0;
};

/// Says which fields are leaves.
class Choose {
  public:
    explicit Choose(Nodes& nodes) : nodes_(nodes) { go_on(0, nullptr, {}); }
    std::vector<MessageLeaf> leaves;

  private:
    using Names = std::vector<std::string>;

    void go_on(std::size_t at, const Names* names, const std::string& read_as) {
        switch (nodes_[at].holds) {
            case Node::Holds::number:
                return add(at, read_as, false);
            case Node::Holds::record:
                return record(at, read_as);
            case Node::Holds::list:
                return list(at, names);
            default:
                return;
        }
    }
    void record(std::size_t at, const std::string& read_as) {
        if (stamp(at, read_as)) return;
        const Names names = names_in(at);
        for (const std::size_t inside : nodes_[at].inside) go_on(inside, &names, path_of(nodes_, inside));
    }
    void list(std::size_t at, const Names* names) {
        const Node& node = nodes_[at];
        if (node.elements > most_listed_elements) return;
        const bool named = names != nullptr && !names->empty() && names->size() == node.inside.size();
        for (std::size_t i = 0; i < node.inside.size(); ++i)
            go_on(node.inside[i], nullptr,
                  named ? fmt::format("{} {}", (*names)[i], node.key) : path_of(nodes_, node.inside[i]));
    }
    // The texts of the list that names the joints of a record.
    Names names_in(std::size_t at) {
        Names names;
        for (const std::size_t inside : nodes_[at].inside) {
            const Node& list = nodes_[inside];
            const bool keyed = list.key == "name" || list.key == "joint_names" || list.key == "names";
            if (!keyed || list.holds != Node::Holds::list || list.elements > most_listed_elements) continue;
            for (const std::size_t element : list.inside) {
                if (nodes_[element].holds != Node::Holds::text) return {};
                nodes_[element].is_name = true;
                names.push_back(nodes_[element].text);
            }
        }
        return names;
    }
    // A record of seconds and nanoseconds, and nothing else.
    bool stamp(std::size_t at, const std::string& read_as) {
        const auto& inside = nodes_[at].inside;
        if (inside.size() != 2) return false;
        for (const std::size_t part : inside)
            if (nodes_[part].holds != Node::Holds::number || unit_of(nodes_[part].key) == 0.0) return false;
        if (unit_of(nodes_[inside[0]].key) == unit_of(nodes_[inside[1]].key)) return false;
        add(at, read_as, true);
        for (const std::size_t part : inside) {
            nodes_[part].nanoseconds = unit_of(nodes_[part].key);
            nodes_[part].leaf = leaves.size() - 1;
        }
        return true;
    }
    static double unit_of(std::string_view key) {
        if (key == "sec" || key == "secs" || key == "seconds") return 1e9;
        return key == "nsec" || key == "nsecs" || key == "nanosec" || key == "nanos" ? 1.0 : 0.0;
    }
    void add(std::size_t at, const std::string& read_as, bool stamp) {
        MessageLeaf leaf;
        leaf.path = path_of(nodes_, at);
        leaf.read_as = read_as;
        leaf.stamp = stamp;
        leaf.clock = stamp && !has_clock_ && (leaf.path == "header.stamp" || leaf.path == "timestamp");
        has_clock_ = has_clock_ || leaf.clock;
        const FieldNumber& number = nodes_[at].number;
        const bool large = number.is_whole && std::abs(number.value) > static_cast<double>(largest_exact);
        leaf.type.kind = stamp || large ? 'i' : 'f';
        leaf.type.size = 8;
        leaf.type.big_endian = std::endian::native == std::endian::big;
        nodes_[at].leaf = leaves.size();
        leaves.push_back(std::move(leaf));
    }

    Nodes& nodes_;
    bool has_clock_ = false;
};

struct Program {
    Nodes nodes;
    std::vector<MessageLeaf> leaves;
};

class Reader final : public MessageReader, private FieldVisitor {
  public:
    Reader(std::shared_ptr<const Program> program, const LeafOffsets& offsets)
        : program_(std::move(program)), offsets_(offsets), elements_(program_->nodes.size()) {}

    void read(std::string_view message, char* into) override {
        into_ = into;
        path_.assign(1, 0);
        std::fill(elements_.begin(), elements_.end(), 0);
        seen_.assign(offsets_.size(), false);
        for (const std::ptrdiff_t offset : offsets_)
            if (offset >= 0) std::memset(into + offset, 0, 8);
        walk(message, *this);
        for (std::size_t leaf = 0; leaf < offsets_.size(); ++leaf)
            if (offsets_[leaf] >= 0 && !seen_[leaf])
                raise<DataError>(
                    "no number as {}, expected one as in the first message; record messages of one shape on "
                    "a "
                    "topic",
                    program_->leaves[leaf].path);
    }

  private:
    static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

    void field(std::string_view name) override {
        if (path_.back() == nowhere) return path_.push_back(nowhere);
        for (const std::size_t inside : program_->nodes[path_.back()].inside)
            if (program_->nodes[inside].key == name) return path_.push_back(inside);
        path_.push_back(nowhere);
    }
    void element() override {
        if (path_.back() == nowhere) return path_.push_back(nowhere);
        const Node& list = program_->nodes[path_.back()];
        const std::size_t number = elements_[path_.back()]++;
        if (number < list.inside.size()) return path_.push_back(list.inside[number]);
        if (list.elements <= most_listed_elements && list.elements > 0)
            raise<DataError>(
                "{} elements of {} and more, expected {} as in the first message; record messages of one "
                "shape on "
                "a topic",
                number + 1, path_of(program_->nodes, path_.back()), list.elements);
        path_.push_back(nowhere);
    }
    void leave() override { path_.pop_back(); }
    void number(const FieldNumber& number) override {
        if (path_.back() == nowhere) return;
        const Node& node = program_->nodes[path_.back()];
        if (!node.leaf || offsets_[*node.leaf] < 0) return;
        seen_[*node.leaf] = true;
        char* const into = into_ + offsets_[*node.leaf];
        if (program_->leaves[*node.leaf].type.kind == 'f') {
            std::memcpy(into, &number.value, 8);
            return;
        }
        std::int64_t whole = 0;
        std::memcpy(&whole, into, 8);
        whole += whole_of(number, node.nanoseconds == 0.0 ? 1.0 : node.nanoseconds);
        std::memcpy(into, &whole, 8);
    }
    static std::int64_t whole_of(const FieldNumber& number, double unit) {
        if (number.is_whole && unit == 1.0) return number.whole;
        const double value = number.value * unit;
        if (!(std::abs(value) < 9e18)) raise<DataError>("{} as a time in seconds", number.value);
        return number.is_whole ? number.whole * static_cast<std::int64_t>(unit) : std::llround(value);
    }
    void text(std::string_view text) override {
        if (path_.back() == nowhere) return;
        const Node& node = program_->nodes[path_.back()];
        if (node.is_name && text != node.text)
            raise<DataError>(
                "'{}' as {}, expected '{}' as in the first message; record the joints on topics of their own",
                text.substr(0, 60), path_of(program_->nodes, path_.back()), node.text);
    }

    std::shared_ptr<const Program> program_;
    LeafOffsets offsets_;
    std::vector<std::size_t> elements_;  ///< of each list, seen in this message
    std::vector<std::size_t> path_;
    std::vector<bool> seen_;
    char* into_ = nullptr;
};

}  // namespace

MessageLayout lay_out_json(std::string_view first) {
    Grow grow;
    walk(first, grow);
    auto program = std::make_shared<Program>();
    program->nodes = std::move(grow.nodes);
    program->leaves = Choose(program->nodes).leaves;
    return {program->leaves, [program](const LeafOffsets& offsets) -> std::unique_ptr<MessageReader> {
                return std::make_unique<Reader>(program, offsets);
            }};
}

}  // namespace ripplenotch
