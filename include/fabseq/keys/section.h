// SPDX-License-Identifier: MIT
/// \file
/// The keys of an object in the config, bound to the members of a settings struct.
#pragma once

#include "fabseq/keys/member.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// The place of the value that a reader reads, for its messages.
struct KeyPlace {
  std::string pointer;  ///< JSON pointer of the value (RFC 6901)
  int dimension;        ///< of the domain, 2 or 3
};

/// The keys of an object. Each key is declared once, with name, member, range, unit, option and meaning; its
/// type and default are those of the member. The declarations, against which a document is checked and
/// completed, read() and write() follow from that. Nothing here is collective.
///
///     Section<ProcessSettings>("process", "Process simulation")
///         .key("min_stiffness", &ProcessSettings::min_stiffness, "Stiffness of ...", {.range = "(0, 1)"});
template <class Settings>
class Section {
 public:
  /// Sets the members of `settings` that follow from `value`.
  using Reader = std::function<void(Settings& settings, const Json& value, const KeyPlace& place)>;
  /// Brings what a completed object has of a key to what the settings say. The settings stay as they are.
  using Writer = std::function<void(Settings& settings, Json& object)>;

  /// `path`: dotted path of the object in the config.
  explicit Section(std::string path, std::string title = "") : own_{std::move(path), std::move(title), {}} {}

  /// Keys declared from here on exist only if the object's "type" is `type`; empty: for every type.
  Section& only_for(std::string type) {
    variant_ = std::move(type);
    return *this;
  }

  /// A key that is bound to a member, by a pointer to the member or by a function that returns a reference to
  /// it.
  template <class Binding>
  Section& key(const char* name, Binding member, const char* meaning, ConfigKey key = {}) {
    const Settings defaults{};
    const auto& initial = std::invoke(member, defaults);
    key.type = type_of(key, initial);
    if (!key.required && key.default_value.empty()) key.default_value = text_of(key, initial);
    key.name = name;
    return add(
        name, meaning, key,
        [member, key](Settings& settings, const Json& value, const KeyPlace&) {
          read_member(key, value, std::invoke(member, settings));
        },
        [member, key](Settings& settings, Json& object) {
          const Settings untouched{};
          write_member(key, std::invoke(member, settings), std::invoke(member, untouched), object);
        });
  }

  /// A key with a reader of its own; type and default are as declared. Without a writer, write() leaves what
  /// was read.
  Section& key(const char* name, const char* meaning, ConfigKey key, Reader read, Writer write = {}) {
    return add(name, meaning, std::move(key), std::move(read), std::move(write));
  }

  /// A key that holds an object with the keys of another section, read into what `member` refers to.
  template <class Binding, class Part>
  Section& section(const char* name, Binding member, const char* meaning, const Section<Part>& keys,
                   ConfigKey key = {}) {
    if (key.type == KeyType::of_member) key.type = KeyType::section;
    for (SectionKeys& declared : keys.declarations()) declare(std::move(declared));
    return add(
        name, meaning, std::move(key),
        [member, keys](Settings& settings, const Json& value, const KeyPlace& place) {
          keys.read(std::invoke(member, settings), value, place);
        },
        [member, keys, of = std::string(name)](Settings& settings, Json& object) {
          if (Json* value = find_member(object, of)) keys.write(std::invoke(member, settings), *value);
        });
  }

  /// Inserts the keys of another section with the same path at this place, for the current type.
  template <class Binding, class Part>
  Section& keys(Binding member, const Section<Part>& other) {
    for (SectionKeys& declared : other.declarations()) {
      if (declared.path != own_.path) {
        declare(std::move(declared));
        continue;
      }
      for (ConfigKey& key : declared.keys) {
        key.variant = variant_;
        own_.keys.push_back(std::move(key));
      }
    }
    return then(
        [member, other](Settings& settings, const Json& value, const KeyPlace& place) {
          other.read(std::invoke(member, settings), value, place);
        },
        [member, other](Settings& settings, Json& object) {
          other.write(std::invoke(member, settings), object);
        });
  }

  /// Adds the declarations of a section that readers of this one take care of.
  Section& declare(SectionKeys section) {
    further_.push_back(std::move(section));
    return *this;
  }

  /// Adds a reader of the whole object, which runs after those of the keys declared so far.
  Section& then(Reader read, Writer write = {}) {
    bound_.push_back({variant_, "", std::move(read), std::move(write)});
    return *this;
  }

  /// The declarations of this section, followed by those of its subsections.
  std::vector<SectionKeys> declarations() const {
    std::vector<SectionKeys> result = {own_};
    result.insert(result.end(), further_.begin(), further_.end());
    return result;
  }

  /// Reads a completed object into `settings`. Throws InputError for faults that a key's own reader finds.
  void read(Settings& settings, const Json& object, const KeyPlace& place) const {
    for (const BoundKey& key : bound_) {
      if (!key.is_of(object)) continue;
      const Json* value = key.name.empty() ? &object : find_member(object, key.name);
      if (value == nullptr) continue;
      key.read(settings, *value,
               key.name.empty() ? place : KeyPlace{pointer_to(place.pointer, key.name), place.dimension});
    }
  }

  /// Brings an object from which the settings were read to what they say now.
  void write(Settings& settings, Json& object) const {
    for (const BoundKey& key : bound_)
      if (key.write && key.is_of(object)) key.write(settings, object);
  }

 private:
  struct BoundKey {
    std::string variant, name;  ///< empty name: the reader reads the whole object
    Reader read;
    Writer write;  ///< may be empty

    bool is_of(const Json& object) const {
      const Json* type = variant.empty() ? nullptr : find_member(object, "type");
      return variant.empty() || (type != nullptr && *type == variant);
    }
  };

  Section& add(const char* name, const char* meaning, ConfigKey key, Reader read, Writer write) {
    key.name = name;
    key.meaning = meaning;
    key.section = own_.path;
    key.variant = variant_;
    own_.keys.push_back(std::move(key));
    bound_.push_back({variant_, name, std::move(read), std::move(write)});
    return *this;
  }

  SectionKeys own_;
  std::vector<SectionKeys> further_;
  std::vector<BoundKey> bound_;
  std::string variant_;
};

}  // namespace fabseq
