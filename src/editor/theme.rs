//! How the editor looks: one calm palette, dark and light, and the spacing of everything.

use eframe::egui::{
    self, Color32, Context, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, TextStyle, Theme,
    Visuals, style::WidgetVisuals, vec2,
};

/// The colours of one theme, from the ground up.
struct Palette {
    ground: Color32,
    panel: Color32,
    raised: Color32,
    hovered: Color32,
    pressed: Color32,
    line: Color32,
    edge: Color32,
    faint: Color32,
    text: Color32,
    strong: Color32,
    accent: Color32,
    selected: Color32,
    warning: Color32,
    error: Color32,
}

const DARK: Palette = Palette {
    ground: Color32::from_rgb(22, 25, 30),
    panel: Color32::from_rgb(32, 36, 43),
    raised: Color32::from_rgb(46, 52, 62),
    hovered: Color32::from_rgb(58, 66, 79),
    pressed: Color32::from_rgb(69, 79, 95),
    line: Color32::from_rgb(50, 56, 66),
    edge: Color32::from_rgb(66, 74, 88),
    faint: Color32::from_rgb(143, 153, 168),
    text: Color32::from_rgb(207, 214, 224),
    strong: Color32::from_rgb(240, 244, 250),
    accent: Color32::from_rgb(122, 176, 240),
    selected: Color32::from_rgb(44, 82, 128),
    warning: Color32::from_rgb(240, 190, 105),
    error: Color32::from_rgb(240, 120, 112),
};

const LIGHT: Palette = Palette {
    ground: Color32::from_rgb(252, 253, 254),
    panel: Color32::from_rgb(238, 241, 245),
    raised: Color32::from_rgb(221, 227, 235),
    hovered: Color32::from_rgb(208, 216, 227),
    pressed: Color32::from_rgb(193, 204, 219),
    line: Color32::from_rgb(207, 213, 222),
    edge: Color32::from_rgb(186, 195, 208),
    faint: Color32::from_rgb(94, 104, 119),
    text: Color32::from_rgb(44, 52, 64),
    strong: Color32::from_rgb(16, 22, 32),
    accent: Color32::from_rgb(24, 98, 184),
    selected: Color32::from_rgb(176, 208, 244),
    warning: Color32::from_rgb(156, 98, 0),
    error: Color32::from_rgb(184, 36, 32),
};

/// Width of the labels of fields, points.
pub(super) const LABEL_WIDTH: f32 = 104.0;

/// A window over everything else, which wants an answer first.
pub(super) fn modal(ctx: &Context, id: &'static str) -> egui::Modal {
    egui::Modal::new(id.into()).frame(egui::Frame::window(&ctx.global_style()))
}

/// Dresses `ctx`; call it once.
pub fn dress(ctx: &Context) {
    let mut fonts = egui::FontDefinitions::default();
    egui_phosphor::add_to_fonts(&mut fonts, egui_phosphor::Variant::Regular);
    ctx.set_fonts(fonts);
    for (theme, palette) in [(Theme::Dark, &DARK), (Theme::Light, &LIGHT)] {
        ctx.style_mut_of(theme, |style| {
            style.visuals = visuals(theme, palette);
            space(style);
        });
    }
}

fn space(style: &mut egui::Style) {
    let font = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, font(11.0)),
        (TextStyle::Body, font(13.0)),
        (TextStyle::Button, font(13.0)),
        (TextStyle::Heading, font(15.5)),
        (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(6.0, 5.0);
    spacing.button_padding = vec2(8.0, 3.0);
    spacing.interact_size = vec2(36.0, 22.0);
    spacing.indent = 14.0;
    spacing.menu_margin = Margin::same(6);
    spacing.window_margin = Margin::same(14);
    spacing.tooltip_width = 320.0;
    spacing.menu_width = 240.0;
    spacing.combo_height = 320.0;
    spacing.scroll = egui::style::ScrollStyle::thin();
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.6;
    // Number fields keep what was typed readable.
    style.drag_value_text_style = TextStyle::Body;
}

fn visuals(theme: Theme, palette: &Palette) -> Visuals {
    let mut visuals = theme.default_visuals();
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.extreme_bg_color = palette.ground;
    visuals.text_edit_bg_color = Some(palette.ground);
    visuals.code_bg_color = palette.ground;
    visuals.faint_bg_color = palette.panel.lerp_to_gamma(palette.raised, 0.35);
    visuals.weak_text_color = Some(palette.faint);
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.selection.bg_fill = palette.selected;
    visuals.selection.stroke = Stroke::new(1.0, palette.strong);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    let shadow = Shadow { offset: [0, 6], blur: 18, spread: 0, color: Color32::from_black_alpha(70) };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;
    visuals.indent_has_left_vline = false;
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive = widget(palette.panel, palette.line, palette.text, 1.0);
    widgets.inactive = widget(palette.raised, palette.edge, palette.text, 1.0);
    widgets.hovered = widget(palette.hovered, palette.faint, palette.strong, 1.0);
    widgets.active = widget(palette.pressed, palette.accent, palette.strong, 1.0);
    widgets.open = widget(palette.hovered, palette.line, palette.strong, 1.0);
    visuals
}

fn widget(fill: Color32, line: Color32, text: Color32, width: f32) -> WidgetVisuals {
    WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::new(width, line),
        corner_radius: CornerRadius::same(4),
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    }
}
