"""The look of the window: the colors of the pictures, quiet panels, one accent."""

from __future__ import annotations

from viewers import theme

PANEL, LINE, ACCENT, ACCENT_LIGHT = "#f6f7f9", "#d5dae1", "#0072b2", "#dcecf6"
WARNING, WARNING_LIGHT = "#9a4507", "#fdf0e1"

SHEET = f"""
* {{ font-size: 13px; color: {theme.INK}; }}
QMainWindow, QScrollArea, QScrollArea > QWidget > QWidget {{ background: {PANEL}; }}
QToolBar {{ background: {PANEL}; border: none; border-bottom: 1px solid {LINE}; spacing: 4px; padding: 4px 6px; }}
QToolBar QToolButton {{ padding: 5px 8px; border-radius: 4px; }}
QToolBar QToolButton#pictures {{ padding-right: 18px; }}
QToolButton#pictures::menu-indicator {{ subcontrol-position: right center; right: 5px; }}
QToolButton#qt_toolbar_ext_button {{ padding: 0px; background: {ACCENT_LIGHT}; }}
QToolBar QToolButton:hover:enabled {{ background: {ACCENT_LIGHT}; }}
QToolBar QToolButton:checked {{ background: {ACCENT_LIGHT}; color: {ACCENT}; }}
QToolBar QToolButton:disabled {{ color: #a3abb6; }}
QToolBar::separator {{ width: 1px; background: {LINE}; margin: 5px 4px; }}
QGroupBox {{ border: none; border-top: 1px solid {LINE}; margin-top: 16px; padding-top: 6px; font-weight: bold; }}
QGroupBox::title {{ subcontrol-origin: margin; left: 0px; top: 0px; color: {theme.MUTED}; background: {PANEL};
    padding-right: 6px; }}
QGroupBox QWidget {{ font-weight: normal; }}
QLabel#title {{ font-size: 15px; font-weight: bold; }}
QLabel#muted, QLabel#note {{ color: {theme.MUTED}; }}
QLabel#problem {{ color: {WARNING}; background: {WARNING_LIGHT}; border-radius: 4px; padding: 2px 6px;
    font-weight: bold; }}
QWidget#paper {{ background: {theme.PAPER}; }}
QTableWidget {{ background: white; border: 1px solid {LINE}; border-radius: 4px; gridline-color: #eceff3; }}
QTableWidget::item {{ padding: 1px 0px; }}
QHeaderView::section {{ background: {PANEL}; border: none; border-bottom: 1px solid {LINE}; padding: 3px 4px;
    color: {theme.MUTED}; }}
QTabWidget::pane {{ border: none; border-top: 1px solid {LINE}; }}
QTabBar::tab {{ padding: 6px 10px; color: {theme.MUTED}; border-bottom: 2px solid transparent; background: {PANEL}; }}
QTabBar::tab:selected {{ color: {ACCENT}; border-bottom: 2px solid {ACCENT}; }}
QSlider::groove:horizontal {{ height: 4px; background: {LINE}; border-radius: 2px; }}
QSlider::sub-page:horizontal {{ background: {ACCENT}; border-radius: 2px; }}
QSlider::handle:horizontal {{ background: white; border: 2px solid {ACCENT}; width: 12px; height: 12px; margin: -6px 0;
    border-radius: 8px; }}
QStatusBar {{ background: {PANEL}; border-top: 1px solid {LINE}; padding: 2px 0; }}
QStatusBar::item {{ border: none; }}
QWidget#stages {{ background: white; border-bottom: 1px solid {LINE}; }}
QPushButton#stage {{ background: white; border: 2px solid {LINE}; border-radius: 14px; padding: 4px 12px;
    color: {theme.MUTED}; }}
QPushButton#stage:checked {{ background: {ACCENT_LIGHT}; border-color: {ACCENT}; color: {theme.INK}; }}
QPushButton#stage:hover {{ border-color: {ACCENT}; }}
QPushButton#stage[running="true"] {{ border-color: {WARNING}; }}
QToolButton#again {{ border: none; border-radius: 4px; padding: 2px 4px; color: {theme.MUTED}; }}
QToolButton#again:hover {{ background: {ACCENT_LIGHT}; color: {ACCENT}; }}
QLabel#arrow {{ color: #a3abb6; }}
QScrollArea {{ border: none; }}
QComboBox#fields {{ combobox-popup: 0; }}
QComboBox#fields QAbstractItemView::item {{ min-height: 21px; padding: 1px 14px; }}
QComboBox#fields QAbstractItemView::item:disabled {{ color: {theme.MUTED}; padding-left: 6px;
    border-top: 1px solid {LINE}; }}
QComboBox#fields QAbstractItemView::item:selected {{ background: {ACCENT_LIGHT}; color: {ACCENT}; }}
"""
