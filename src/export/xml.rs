//! Mitsuba's XML: elements with attributes and children, without text.

use std::fmt::{self, Display, Write};

/// An element; `Display` writes it with its children.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    pub fn new(tag: &'static str) -> Self {
        Self { tag, attributes: Vec::new(), children: Vec::new() }
    }

    /// An object of Mitsuba, made by the plugin `kind`.
    pub fn plugin(tag: &'static str, kind: &str) -> Self {
        Self::new(tag).with("type", kind)
    }

    /// A property of an object: a number or a word.
    pub fn value(tag: &'static str, name: &str, value: impl Display) -> Self {
        Self::new(tag).with("name", name).with("value", value)
    }

    pub fn rgb(name: &str, [r, g, b]: [f32; 3]) -> Self {
        Self::value("rgb", name, format!("{r} {g} {b}"))
    }

    pub fn point(tag: &'static str, name: &str, [x, y, z]: [f32; 3]) -> Self {
        Self::new(tag).with("name", name).with("x", x).with("y", y).with("z", z)
    }

    /// A transform from its origin, target and up vector.
    pub fn look_at(origin: glam::Vec3, target: glam::Vec3, up: glam::Vec3) -> Self {
        let list = |v: glam::Vec3| format!("{}, {}, {}", v.x, v.y, v.z);
        let look = Self::new("lookat").with("origin", list(origin)).with("target", list(target)).with("up", list(up));
        Self::new("transform").with("name", "to_world").child(look)
    }

    /// A rotation about +Y, degrees.
    pub fn rotation_y(degrees: f32) -> Self {
        let rotate = Self::new("rotate").with("y", 1).with("angle", degrees);
        Self::new("transform").with("name", "to_world").child(rotate)
    }

    pub fn with(mut self, attribute: &'static str, value: impl Display) -> Self {
        self.attributes.push((attribute, value.to_string()));
        self
    }

    pub fn child(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    pub fn children(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    pub fn is_plugin(&self, tag: &str, kind: &str) -> bool {
        self.tag == tag && self.attributes.iter().any(|(name, value)| *name == "type" && value == kind)
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, depth: usize) -> fmt::Result {
        write!(f, "{:1$}<{2}", "", 4 * depth, self.tag)?;
        for (name, value) in &self.attributes {
            write!(f, " {name}=\"")?;
            value.chars().try_for_each(|c| match c {
                '&' => f.write_str("&amp;"),
                '<' => f.write_str("&lt;"),
                '>' => f.write_str("&gt;"),
                '"' => f.write_str("&quot;"),
                // XML has no spelling for control characters.
                c if c.is_control() => f.write_char(' '),
                c => f.write_char(c),
            })?;
            f.write_char('"')?;
        }
        if self.children.is_empty() {
            return f.write_str("/>\n");
        }
        f.write_str(">\n")?;
        self.children.iter().try_for_each(|child| child.write(f, depth + 1))?;
        writeln!(f, "{:1$}</{2}>", "", 4 * depth, self.tag)
    }
}

impl Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_their_values_are_escaped() {
        let element = Element::plugin("bsdf", "a<b>&\"c\"\n").child(Element::rgb("reflectance", [0.5, 1.0, 1e-9]));
        assert_eq!(
            element.to_string(),
            "<bsdf type=\"a&lt;b&gt;&amp;&quot;c&quot; \">\n    <rgb name=\"reflectance\" value=\"0.5 1 0.000000001\"/>\n</bsdf>\n"
        );
    }
}
