#include "materials/readers/yaml_node.h"

#include <fmt/format.h>
#include <yaml.h>

#include <memory>

#include <miebrdf/database.h>

namespace miebrdf::materials {
namespace {

constexpr int kDeepestNesting = 32;

class EventParser {
  public:
    EventParser(std::string_view text, const std::string& file) : file_(file) {
        if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
        yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                     text.size());
    }
    ~EventParser() {
        yaml_event_delete(&event_);
        yaml_parser_delete(&parser_);
    }
    EventParser(const EventParser&) = delete;
    EventParser& operator=(const EventParser&) = delete;

    void advance() {
        yaml_event_delete(&event_);
        if (yaml_parser_parse(&parser_, &event_) == 0) {
            event_ = {};
            fail(static_cast<int>(parser_.problem_mark.line) + 1,
                 fmt::format("no YAML: {}", parser_.problem != nullptr ? parser_.problem : "?"));
        }
    }
    yaml_event_type_t type() const { return event_.type; }
    int line() const { return static_cast<int>(event_.start_mark.line) + 1; }

    /// The node that begins with the current event.
    YamlNode node(int depth) {
        if (depth > kDeepestNesting)
            fail(line(), fmt::format("nested deeper than {}", kDeepestNesting));
        YamlNode node;
        node.line = line();
        switch (type()) {
            case YAML_SCALAR_EVENT:
                node.text = scalar();
                break;
            case YAML_SEQUENCE_START_EVENT:
                refuse_anchor(event_.data.sequence_start.anchor);
                node.kind = YamlNode::Kind::sequence;
                for (advance(); type() != YAML_SEQUENCE_END_EVENT; advance()) {
                    node.items.push_back(this->node(depth + 1));
                }
                break;
            case YAML_MAPPING_START_EVENT:
                refuse_anchor(event_.data.mapping_start.anchor);
                node.kind = YamlNode::Kind::mapping;
                for (advance(); type() != YAML_MAPPING_END_EVENT; advance()) {
                    if (type() != YAML_SCALAR_EVENT) fail(line(), "a key that is no plain text");
                    std::string key = scalar();
                    advance();
                    node.keys.push_back(std::move(key));
                    node.items.push_back(this->node(depth + 1));
                }
                break;
            default:
                fail(line(), "YAML aliases are not supported");
        }
        return node;
    }

  private:
    [[noreturn]] void fail(int line, const std::string& reason) const {
        throw ImportError(file_, line, reason);
    }
    void refuse_anchor(const unsigned char* anchor) const {
        if (anchor != nullptr) fail(line(), "YAML anchors are not supported");
    }
    std::string scalar() const {
        refuse_anchor(event_.data.scalar.anchor);
        return {reinterpret_cast<const char*>(event_.data.scalar.value), event_.data.scalar.length};
    }

    const std::string& file_;
    yaml_parser_t parser_{};
    yaml_event_t event_{};
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (keys[i] == key) return &items[i];
    }
    return nullptr;
}

std::string YamlNode::text_of(std::string_view key) const {
    const YamlNode* value = find(key);
    return value != nullptr && value->kind == Kind::scalar ? value->text : "";
}

YamlNode parse_yaml(std::string_view text, const std::string& file) {
    EventParser parser(text, file);
    parser.advance();  // stream start
    parser.advance();
    if (parser.type() == YAML_STREAM_END_EVENT) throw ImportError(file, 0, "empty YAML");
    parser.advance();  // the root node
    return parser.node(0);
}

}  // namespace miebrdf::materials
