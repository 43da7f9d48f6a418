#include "tests/ros/arguments.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include "tests/ros/output.hpp"

namespace octoskin::ros {

Arguments::Arguments(int count, char** words, const std::set<std::string>& flags,
                     const std::set<std::string>& options) {
    for (int i = 1; i < count; ++i) {
        const std::string word = words[i];
        if (flags.contains(word)) {
            given_[word];
        } else if (options.contains(word)) {
            if (i + 1 == count) {
                throw std::invalid_argument(word + " needs a value");
            }
            given_[word] = words[++i];
        } else if (word.starts_with("--")) {
            throw std::invalid_argument("unknown option " + word);
        } else {
            rest_.push_back(word);
        }
    }
}

std::string Arguments::text(const std::string& name, const std::string& otherwise) const {
    const auto found = given_.find(name);
    return found == given_.end() ? otherwise : found->second;
}

std::string Arguments::choice(const std::string& name, const std::vector<std::string>& allowed) const {
    const std::string value = text(name, allowed.front());
    if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
        throw std::invalid_argument(name + ": unknown value '" + value + "'");
    }
    return value;
}

double Arguments::number(const std::string& name, double otherwise) const {
    if (!has(name)) {
        return otherwise;
    }
    const std::string value = given_.at(name);
    std::size_t read = 0;
    double number = -1;
    try {
        number = std::stod(value, &read);
    } catch (const std::exception&) {
        read = 0;
    }
    if (read == 0 || read != value.size() || !(number >= 0)) {
        throw std::invalid_argument(name + ": not a number of at least 0: '" + value + "'");
    }
    return number;
}

int Arguments::whole(const std::string& name, int otherwise) const {
    const double value = number(name, otherwise);
    if (!(value <= 1e9) || value != static_cast<int>(value)) {
        throw std::invalid_argument(name + ": not a whole number");
    }
    return static_cast<int>(value);
}

int run_program(int count, char** words, const char* usage, int (*program)(int, char**)) {
    const std::string name = std::string(words[0]).substr(std::string(words[0]).rfind('/') + 1);
    if (count > 1 && std::string(words[1]) == "--help") {
        std::cout << usage;
        return 0;
    }
    try {
        return is_told_to_end() ? 1 : program(count, words);
    } catch (const std::invalid_argument& error) {
        std::cerr << name << ": " << error.what() << '\n';
        return 2;
    } catch (const std::exception& error) {
        std::cerr << name << ": " << error.what() << '\n';
        return 1;
    }
}

}  // namespace octoskin::ros
