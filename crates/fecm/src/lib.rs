//! Finite-element/contact-mechanics model of gear tooth contact.
