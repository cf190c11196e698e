#include "commands/commands.hpp"

int main(int argc, char** argv) { return octurn::run(argc, argv); }
