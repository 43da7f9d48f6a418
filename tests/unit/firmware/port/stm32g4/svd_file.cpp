#include "tests/unit/firmware/port/stm32g4/svd_file.hpp"

#include <tinyxml2.h>

#include <stdexcept>

namespace octoskin::test {

namespace {

using tinyxml2::XMLElement;

std::string text_of(const XMLElement& parent, const char* name) {
    const XMLElement* child = parent.FirstChildElement(name);
    return child != nullptr && child->GetText() != nullptr ? child->GetText() : "";
}

unsigned number_of(const XMLElement& parent, const char* name) {
    const std::string text = text_of(parent, name);
    return text.empty() ? 0 : static_cast<unsigned>(std::stoul(text, nullptr, 0));
}

std::string without_prefix(const std::string& name, const std::string& peripheral) {
    const std::string prefix = peripheral + "_";
    return name.rfind(prefix, 0) == 0 ? name.substr(prefix.size()) : name;
}

SvdRegister read_register(const XMLElement& element) {
    SvdRegister result{.offset = number_of(element, "addressOffset"), .fields = {}};
    const XMLElement* fields = element.FirstChildElement("fields");
    if (fields == nullptr) return result;
    for (const XMLElement* field = fields->FirstChildElement("field"); field != nullptr;
         field = field->NextSiblingElement("field")) {
        result.fields[text_of(*field, "name")] = {.lsb = number_of(*field, "bitOffset"),
                                                  .width = number_of(*field, "bitWidth")};
    }
    return result;
}

void read_peripheral(const XMLElement& element, SvdFile& file) {
    const std::string name = text_of(element, "name");
    SvdPeripheral peripheral;
    const char* base = element.Attribute("derivedFrom");
    if (base != nullptr) peripheral = file.peripherals.at(base);
    peripheral.base = number_of(element, "baseAddress");
    if (const XMLElement* registers = element.FirstChildElement("registers")) {
        for (const XMLElement* entry = registers->FirstChildElement("register"); entry != nullptr;
             entry = entry->NextSiblingElement("register")) {
            peripheral.registers[without_prefix(text_of(*entry, "name"), name)] = read_register(*entry);
        }
    }
    for (const XMLElement* entry = element.FirstChildElement("interrupt"); entry != nullptr;
         entry = entry->NextSiblingElement("interrupt")) {
        file.interrupts[text_of(*entry, "name")] = number_of(*entry, "value");
    }
    file.peripherals[name] = peripheral;
}

}  // namespace

SvdFile read_svd(const std::string& path) {
    tinyxml2::XMLDocument document;
    if (document.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS) {
        throw std::runtime_error(path + ": " + document.ErrorStr());
    }
    const XMLElement* device = document.FirstChildElement("device");
    const XMLElement* peripherals = device != nullptr ? device->FirstChildElement("peripherals") : nullptr;
    if (peripherals == nullptr) throw std::runtime_error(path + ": no peripherals");
    SvdFile file;
    for (const XMLElement* entry = peripherals->FirstChildElement("peripheral"); entry != nullptr;
         entry = entry->NextSiblingElement("peripheral")) {
        read_peripheral(*entry, file);
    }
    return file;
}

}  // namespace octoskin::test
