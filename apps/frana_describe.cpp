#include <iostream>

#include "frana_commands.h"
#include "scene/parameters.h"

namespace frana {

int describe_command(const std::string& key) {
    std::cout << describe(key);
    return 0;
}

}  // namespace frana
