#include <miebrdf/error.h>
#include <miebrdf/optics.h>

#include <iostream>

void show_error() {
    try {
        miebrdf::rte::isotropic_optics(1.2);
    } catch (const miebrdf::UsageError& error) {  // the request is wrong
        std::cout << error.field() << " = " << error.value() << ", allowed: " << error.allowed()
                  << '\n';
    } catch (const miebrdf::InputError& error) {  // data are missing or damaged
        std::cout << error.what() << '\n';
    } catch (const miebrdf::Cancelled&) {  // Control::is_cancelled said so
        std::cout << "stopped\n";
    }
}
