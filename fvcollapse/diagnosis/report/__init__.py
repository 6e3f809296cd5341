"""The report of a diagnosis: its content, its file, its words, figures and page."""

from fvcollapse.diagnosis.report.report_file import FILE_NAME, read_report, write_report
from fvcollapse.diagnosis.report.schema import Report

__all__ = ["FILE_NAME", "Report", "read_report", "write_report"]
